// What a merge cannot go on from is found before anybody tries, and what it can is not complained about.
#include "server/jobs/merge_check.h"

#include <functional>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/merge/merge_options.h"
#include "schema/merges/merge_state_check.h"
#include "schema/merges/merge_state_store.h"
#include "server/jobs/merge_jobs.h"
#include "tests/server/jobs/stored_toy_maps.h"

namespace mapweld::server {
namespace {

using test::ToyWorld;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

class MergeCheckTest : public testing::TestWithParam<std::string_view> {
 protected:
  MergeJobOptions options() const {
    return test::job_options(std::make_shared<test::HashVerifier>(world_.accept_share));
  }
  // Merges "a" and "b" up to so many verifications.
  JobId merge(std::uint64_t verifications, const std::string& name = "ab") {
    MergeRequest request = test::request_of(world_, name);
    request.budget.verifications = verifications;
    MergeJobs jobs(store_, options());
    jobs.start();
    const std::int64_t id = jobs.submit(request).id;
    EXPECT_NE(jobs.wait(id, std::chrono::seconds(60)).state, JobState::kFailed);
    return JobId{id};
  }
  MergeCheck check(JobId job) { return check(store_.read(), job); }
  MergeCheck check(const Reader& db, JobId job) { return check_merge(db, *find_merge(db, job), options().verifier); }
  // What is found after `damage`, which is not kept.
  std::vector<std::string> found_after(JobId job, const std::string& damage) {
    WriteTransaction db = store_.write();
    db.connection().execute(damage);
    return check(db, job).findings;
  }

  ToyWorld world_ = test::toy_world(19);
  test::TempStore store_;
};

TEST_P(MergeCheckTest, MergesOfEveryMethodGoOnFromWhereverTheyStopped) {
  world_.method = GetParam();
  test::store_toy_maps(store_, world_);
  for (const std::uint64_t verifications : {1, 7, 40, 1'000'000}) {
    const JobId job = merge(verifications, "ab" + std::to_string(verifications));
    const MergeCheck found = check(job);
    EXPECT_THAT(found.findings, IsEmpty()) << verifications;
    EXPECT_THAT(found.notes, IsEmpty()) << verifications;
    const ReadTransaction db = store_.read();
    EXPECT_THAT(check_merge_state(db, *find_merge(db, job)), IsEmpty()) << verifications;
  }
}

INSTANTIATE_TEST_SUITE_P(Methods, MergeCheckTest, testing::ValuesIn(merge_methods()),
                         [](const auto& info) { return test::name_of_test(info.param); });

using MergeCheckDamage = MergeCheckTest;

TEST_F(MergeCheckDamage, EachThingThatAResumeWouldStumbleOverIsFound) {
  test::store_toy_maps(store_, world_);
  const JobId job = merge(40);
  const std::vector<std::pair<std::string, std::string>> cases = {
      {"UPDATE merges SET seed = seed + 1", "another verifier"},
      {"UPDATE merges SET parameters = json_set(parameters, '$.min_votes', 5)", "another verifier"},
      {"UPDATE merges SET method = 'brute-force'", "another merge method"},
      // Other images than those that the state is about.
      {"UPDATE appearances SET bytes = (SELECT bytes FROM appearances WHERE map = 1 AND vertex = 5) "
       "WHERE map = 1 AND vertex = 4",
       "other maps"},
      {"DELETE FROM edges WHERE id = (SELECT min(id) FROM edges WHERE job IS NOT NULL)", "are stored"},
      {"DELETE FROM checkpoints WHERE part = 'similarity'", "similarity"},
  };
  for (const auto& [damage, says] : cases) {
    EXPECT_THAT(found_after(job, damage),
                ElementsAre(testing::AllOf(HasSubstr("cannot go on"), HasSubstr(says), HasSubstr("restart the merge"))))
        << damage;
  }
  EXPECT_THAT(found_after(job,
                          "UPDATE edges SET votes = votes + 1 "
                          "WHERE id = (SELECT min(id) FROM edges WHERE job IS NOT NULL)"),
              ElementsAre(HasSubstr("its images give each other")));
  EXPECT_THAT(found_after(job, "DELETE FROM appearances WHERE map = 1 AND vertex = 4"),
              ElementsAre(HasSubstr("cannot be loaded")));
}

TEST_F(MergeCheckDamage, ACancelledMergeIsNotAskedWhetherItCouldGoOn) {
  test::store_toy_maps(store_, world_);
  const JobId job = merge(40);
  EXPECT_THAT(found_after(job, "UPDATE merges SET seed = 9, state = 'cancelled'"), IsEmpty());
}

TEST_F(MergeCheckDamage, AnotherVersionOfTheVerifierIsNotedAndIsNoDamage) {
  test::store_toy_maps(store_, world_);
  const JobId job = merge(40);
  WriteTransaction db = store_.write();
  db.connection().execute("UPDATE verifiers SET version = 'hash-0' WHERE version = 'hash-1'");
  const MergeCheck found = check(db, job);
  EXPECT_THAT(found.findings, IsEmpty());
  EXPECT_THAT(found.notes, ElementsAre(testing::AllOf(HasSubstr("hash-0"), HasSubstr("hash-1"), HasSubstr("restart"))));
}

TEST_F(MergeCheckDamage, AMergeOfGrownMembersGoesOnAndItsDamageIsFound) {
  world_.sizes = {20, 16};
  test::store_toy_maps(store_, world_);
  const JobId job = merge(1'000'000);
  // The toy world numbers all its vertices anew when it grows: any further images will do.
  const MapRow b = *find_map(store_.read(), "b");
  test::Random random(3);
  for (int i = 0; i < 3; ++i) {
    test::add_vertex(store_, b.id, b.vocabulary, "new" + std::to_string(i),
                     test::random_appearances(random, 20, 1'000));
  }
  {
    WriteTransaction db = store_.write();
    ASSERT_EQ(extend_merged_map(db, find_merge(db, job)->map), 3U);
    db.commit();
  }
  EXPECT_THAT(check(job).findings, IsEmpty());
  EXPECT_THAT(found_after(job, "UPDATE merges SET seed = seed + 1"), ElementsAre(HasSubstr("another verifier")));
}

}  // namespace
}  // namespace mapweld::server
