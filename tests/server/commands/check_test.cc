#include "server/commands/check.h"

#include <chrono>
#include <memory>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/geometry/epipolar_verifier.h"
#include "schema/key_store.h"
#include "server/jobs/merge_jobs.h"
#include "tests/server/commands/run_command.h"
#include "tests/server/jobs/stored_toy_maps.h"
#include "tests/support/temp_store.h"

namespace mapweld::test {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

Ran check(const std::string& data, const std::string& flags = {}) {
  return run_command(server::add_check_command, "check --data " + data + flags);
}

// Accepts about half of all pairs, on no matches that one could look at.
class OtherVerifier final : public PairVerifier {
 public:
  Verification verify(const AppearanceVector& a, const AppearanceVector& b) const override {
    Verification verdict = verdicts_.verify(a, b);
    verdict.inlier_matches.clear();
    return verdict;
  }
  std::string version() const override { return "other-1"; }
  const VerifierOptions& options() const override { return verdicts_.options(); }

 private:
  HashVerifier verdicts_{0.5};
};

TEST(CheckCommand, FindsAWholeFolderInOrderAlsoBesideAServer) {
  TempStore store;
  const VocabularyId vocabulary = add_vocabulary(store);
  Random random(1);
  add_vertex(store, add_map(store, "lab", vocabulary), vocabulary, "a", random_appearances(random, 50, 1000));
  const Ran run = check((store.folder() / "data").string());
  EXPECT_EQ(run.exit_code, 0) << run.output << run.errors;
  EXPECT_THAT(run.output, HasSubstr("1 maps, 1 images"));
  EXPECT_THAT(run.output, HasSubstr("all in order"));
}

TEST(CheckCommand, NamesWhatIsDamaged) {
  TempStore store;
  const VocabularyId vocabulary = add_vocabulary(store);
  Random random(1);
  add_vertex(store, add_map(store, "lab", vocabulary), vocabulary, "a", random_appearances(random, 50, 1000));
  {
    WriteTransaction db = store.write();
    db.prepare("UPDATE maps SET vertices = 7").run();
    db.commit();
  }
  const Ran run = check((store.folder() / "data").string());
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_THAT(run.output, HasSubstr("findings"));
  EXPECT_THAT(run.output, HasSubstr("lab"));
}

TEST(CheckCommand, LooksAtTheKeysToo) {
  TempStore store;
  const std::filesystem::path data = store.folder() / "data";
  KeyRow key;
  key.name = "robot";
  key.role = "read";
  key.maps = "*";
  KeyStore(data).add(key);
  EXPECT_EQ(check(data.string()).exit_code, 0);
  sqlite::Connection(data / "keys.db", sqlite::OpenMode::kReadWrite).execute("UPDATE keys SET role = 'admin'");
  const Ran run = check(data.string());
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_THAT(run.output, AllOf(HasSubstr("keys: "), HasSubstr("its checksum does not match")));
}

TEST(CheckCommand, NamesAMergeThatCannotGoOnAndWhatHelps) {
  TempStore store;
  const ToyWorld world = toy_world(19);
  store_toy_maps(store, world);
  const auto run = [&](const std::string& name, const server::MergeJobOptions& options) {
    server::MergeJobs jobs(store, options);
    jobs.start();
    server::MergeRequest request = request_of(world, name);
    request.budget.verifications = 20;
    jobs.wait(jobs.submit(request).id, std::chrono::seconds(60));
  };
  server::MergeJobOptions options;
  options.verifier = make_verifier;
  run("ours", options);
  const std::string data = (store.folder() / "data").string();
  Ran found = check(data);
  EXPECT_EQ(found.exit_code, 0) << found.output << found.errors;
  EXPECT_THAT(found.output, HasSubstr("all in order"));
  // Verdicts of another verifier are noted.
  run("theirs", job_options(std::make_shared<OtherVerifier>()));
  found = check(data);
  EXPECT_EQ(found.exit_code, 0) << found.output << found.errors;
  EXPECT_THAT(found.output, HasSubstr("note: checkpoints: merge 2: its verdicts are of the verifier other-1"));
  EXPECT_THAT(found.output, HasSubstr("all in order"));
  {
    WriteTransaction db = store.write();
    db.prepare("UPDATE merges SET seed = seed + 1 WHERE id = 1").run();
    db.prepare("DELETE FROM checkpoints WHERE job = 2 AND part = 'queue'").run();
    db.commit();
  }
  found = check(data);
  EXPECT_EQ(found.exit_code, 1);
  EXPECT_THAT(found.output, HasSubstr("checkpoints: merge 1: it cannot go on"));
  EXPECT_THAT(found.output, HasSubstr("checkpoints: merge 2: a merge's checkpoint is damaged"));
  EXPECT_THAT(found.output, HasSubstr("restart the merge"));
  EXPECT_THAT(found.output, HasSubstr("2 findings"));  // each told once
  // What stands in the rows is compared all the same.
  found = check(data, " --shallow");
  EXPECT_EQ(found.exit_code, 1);
  EXPECT_THAT(found.output, HasSubstr("1 findings"));
  EXPECT_THAT(found.output, HasSubstr("merge 2"));
}

TEST(CheckCommand, SaysWhyAFolderCannotBeRead) {
  const TempFolder folder;
  const Ran run = check((folder.path() / "nothing").string());
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_THAT(run.errors, HasSubstr("mapweld-server: "));
}

}  // namespace
}  // namespace mapweld::test
