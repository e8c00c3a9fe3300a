#include "schema/merges/merge_store.h"

#include <map>

#include <gtest/gtest.h>

#include "tests/support/temp_store.h"

namespace mapweld {
namespace {

using test::Random;
using test::TempStore;

class MergeStoreTest : public testing::Test {
 protected:
  void SetUp() override {
    for (int i = 0; i < 10; ++i) {
      for (const MapId map : {a_, b_}) {
        test::add_vertex(store_, map, vocabulary_, std::to_string(i), AppearanceVector{320, 240, {}});
      }
    }
  }

  JobId submit(std::string_view name, std::uint64_t seed = 7) {
    WriteTransaction db = store_.write();
    const MapId merged = insert_merged_map(db, test::new_map(name, vocabulary_), std::vector{a_, b_});
    const JobId job =
        insert_merge(db, {merged, "quickconnect", seed, R"({"min_votes":12})", R"({"seconds":1.5})", test::at(10)});
    db.commit();
    return job;
  }

  std::optional<std::uint64_t> claim(JobId job) {
    WriteTransaction db = store_.write();
    const auto epoch = claim_merge(db, job, test::at(11));
    db.commit();
    return epoch;
  }

  MergeRow row(JobId job) { return find_merge(store_.read(), job).value(); }

  NewEdge edge(std::uint32_t u, std::uint32_t v) {
    return {VertexId{u}, VertexId{v}, 50, test::random_verification(random_, 20, 400, 400), {}, u + v, 0.25};
  }

  // Saves one part, edges and a point of the curve.
  bool save(JobId job, std::uint64_t epoch, std::uint64_t step, const std::vector<NewEdge>& edges = {}) {
    const auto bytes = test::random_bytes(random_, 100);
    const CheckpointPart part{"state", bytes};
    CurvePointRow point;
    point.step = step;
    point.phase = "exploration";
    WriteTransaction db = store_.write();
    CheckpointWrite checkpoint;
    checkpoint.step = step;
    checkpoint.phase = "exploration";
    checkpoint.spent = {0.5, 10, edges.size()};
    checkpoint.parts = std::span(&part, 1);
    checkpoint.edges = edges;
    checkpoint.verifier = test::test_verifier(db);
    checkpoint.curve_points = std::span(&point, 1);
    checkpoint.now = test::at(12);
    const bool saved = save_checkpoint(db, job, epoch, checkpoint);
    db.commit();
    return saved;
  }

  // Everything stored of all jobs, to see that nothing changed.
  std::string everything() {
    const ReadTransaction reader = store_.read();
    std::string all;
    for (const char* table : {"merges", "checkpoints", "curve_points", "edges", "maps"}) {
      sqlite::Statement statement = reader.prepare("SELECT * FROM " + std::string(table));
      while (statement.step()) {
        for (int c = 0; c < 11; ++c) all += std::string(statement.text(c)) + "|";
      }
    }
    return all;
  }

  TempStore store_;
  Random random_{51};
  VocabularyId vocabulary_ = test::add_vocabulary(store_);
  MapId a_ = test::add_map(store_, "a", vocabulary_);
  MapId b_ = test::add_map(store_, "b", vocabulary_);
};

TEST_F(MergeStoreTest, StatesHaveTheWordsOfTheContract) {
  for (int s = 0; s <= static_cast<int>(JobState::kFailed); ++s) {
    EXPECT_EQ(parse_job_state(to_string(static_cast<JobState>(s))), static_cast<JobState>(s));
  }
  EXPECT_EQ(to_string(JobState::kBudgetExhausted), "budget_exhausted");
  EXPECT_EQ(parse_job_state("dancing"), std::nullopt);
}

TEST_F(MergeStoreTest, AJobComesBackAsItWasSubmitted) {
  const JobId job = submit("ab", 0xFFFF'FFFF'FFFF'FFF7);
  store_.reopen();
  const MergeRow merge = row(job);
  EXPECT_EQ(merge.id, job);
  EXPECT_EQ(merge.map_name, "ab");
  EXPECT_EQ(merge.method, "quickconnect");
  EXPECT_EQ(merge.seed, 0xFFFF'FFFF'FFFF'FFF7);
  EXPECT_EQ(merge.parameters, R"({"min_votes":12})");
  EXPECT_EQ(merge.budget, R"({"seconds":1.5})");
  EXPECT_EQ(merge.state, JobState::kQueued);
  EXPECT_EQ(merge.phase, "voting");
  EXPECT_EQ(merge.spent, Spent{});
  EXPECT_EQ(merge.checkpoint_at, std::nullopt);
  EXPECT_EQ(merge.created_at, test::at(10));
  const ReadTransaction reader = store_.read();
  EXPECT_EQ(find_merge_of(reader, merge.map)->id, job);
  EXPECT_FALSE(find_merge_of(reader, a_));
  EXPECT_FALSE(find_merge(reader, JobId{99}));
  EXPECT_TRUE(load_checkpoint(reader, job).empty());
}

TEST_F(MergeStoreTest, PartsOfTheStateAreReplacedKeptAndDroppedByName) {
  const JobId job = submit("ab");
  const std::uint64_t epoch = claim(job).value();
  std::map<std::string, std::vector<std::uint8_t>> model;
  const std::vector<std::string> names = {"matrix", "queue", "list", "random"};
  for (int round = 0; round < 12; ++round) {
    std::vector<std::pair<std::string, std::vector<std::uint8_t>>> written;
    std::vector<std::string> dropped;
    for (const std::string& name : names) {
      if (random_.chance(0.2)) {
        dropped.push_back(name);
        model.erase(name);
      } else if (random_.chance(0.5)) {
        // Longer than a chunk now and then; empty now and then.
        const std::size_t bytes = random_.chance(0.2)   ? 0
                                  : random_.chance(0.2) ? (17U << 20) + 3
                                                        : random_.below(5'000);
        written.emplace_back(name, std::vector<std::uint8_t>(bytes, static_cast<std::uint8_t>(round)));
        model[name] = written.back().second;
      }
    }
    std::vector<CheckpointPart> parts;
    for (const auto& [name, bytes] : written) parts.push_back({name, bytes});
    WriteTransaction db = store_.write();
    CheckpointWrite checkpoint;
    checkpoint.step = static_cast<std::uint64_t>(round);
    checkpoint.phase = "voting";
    checkpoint.parts = parts;
    checkpoint.dropped_parts = dropped;
    ASSERT_TRUE(save_checkpoint(db, job, epoch, checkpoint));
    db.commit();
    std::map<std::string, std::vector<std::uint8_t>> read;
    for (StoredPart& part : load_checkpoint(store_.read(), job)) read[part.name] = std::move(part.bytes);
    for (const auto& [name, bytes] : read) {
      const auto part = load_checkpoint_part(store_.read(), job, name);
      ASSERT_TRUE(part) << name;
      EXPECT_EQ(part->name, name);
      EXPECT_TRUE(part->bytes == bytes) << name;
    }
    EXPECT_FALSE(load_checkpoint_part(store_.read(), job, "none"));
    ASSERT_EQ(read, model) << "round " << round;
  }
}

TEST_F(MergeStoreTest, ACheckpointIsEverythingInOneTransaction) {
  const JobId job = submit("ab");
  const std::uint64_t epoch = claim(job).value();
  ASSERT_TRUE(save(job, epoch, 100, {edge(0, 10), edge(3, 15)}));
  ASSERT_TRUE(save(job, epoch, 200, {edge(1, 11)}));
  const std::string before = everything();
  // The last edge of three is there already: nothing of the checkpoint may stay.
  EXPECT_THROW(save(job, epoch, 300, {edge(4, 14), edge(5, 15), edge(0, 10)}), StoreError);
  EXPECT_EQ(everything(), before);
  store_.reopen();
  EXPECT_EQ(everything(), before);
  const MergeRow merge = row(job);
  EXPECT_EQ(merge.step, 200U);
  EXPECT_EQ(merge.checkpoint_at, test::at(12));
  EXPECT_EQ(merge.state, JobState::kRunning);
  const ReadTransaction reader = store_.read();
  EXPECT_EQ(list_merge_edges(reader, job, 100).size(), 3U);
  EXPECT_EQ(list_curve(reader, job, 100).size(), 2U);
}

TEST_F(MergeStoreTest, ALateWorkerChangesNothing) {
  const JobId job = submit("ab");
  const std::uint64_t late = claim(job).value();
  ASSERT_TRUE(save(job, late, 1));
  EXPECT_EQ(claim(job), std::nullopt);  // it is running already
  {
    WriteTransaction db = store_.write();
    EXPECT_EQ(recover_merges(db, test::at(20)), std::vector{job});
    db.commit();
  }
  EXPECT_EQ(row(job).state, JobState::kQueued);
  EXPECT_FALSE(save(job, late, 2));
  const std::uint64_t next = claim(job).value();
  EXPECT_NE(next, late);
  const std::string before = everything();
  EXPECT_FALSE(save(job, late, 2, {edge(0, 10)}));
  {
    WriteTransaction db = store_.write();
    EXPECT_FALSE(end_run(db, job, late, {JobState::kCompleted, std::nullopt, std::nullopt, test::at(30)}));
    db.commit();
  }
  EXPECT_EQ(everything(), before);
  EXPECT_TRUE(save(job, next, 2, {edge(0, 10)}));
}

TEST_F(MergeStoreTest, ADeletedJobTakesNothingMore) {
  const JobId job = submit("ab");
  const std::uint64_t epoch = claim(job).value();
  ASSERT_TRUE(save(job, epoch, 1, {edge(0, 10)}));
  {
    WriteTransaction db = store_.write();
    EXPECT_EQ(delete_merge(db, job), DeleteOutcome::kDeleted);
    EXPECT_EQ(delete_merge(db, job), DeleteOutcome::kNotFound);
    db.commit();
  }
  EXPECT_FALSE(save(job, epoch, 2, {edge(1, 11)}));
  const ReadTransaction reader = store_.read();
  for (const char* table : {"merges", "checkpoints", "curve_points", "edges", "member_spans"}) {
    EXPECT_EQ(reader.connection().query_integer("SELECT count(*) FROM " + std::string(table)), 0) << table;
  }
  EXPECT_FALSE(find_map(reader, "ab"));
  EXPECT_EQ(find_map(reader, a_)->vertices, 10U);
  EXPECT_NE(submit("ab"), job);  // numbers never come back
}

TEST_F(MergeStoreTest, ARunEndsInAStateWithItsReason) {
  const JobId job = submit("ab");
  const std::uint64_t epoch = claim(job).value();
  {
    WriteTransaction db = store_.write();
    EXPECT_TRUE(end_run(db, job, epoch, {JobState::kBudgetExhausted, "seconds", std::nullopt, test::at(30)}));
    EXPECT_FALSE(end_run(db, job, epoch, {JobState::kCompleted, std::nullopt, std::nullopt, test::at(31)}));
    db.commit();
  }
  EXPECT_EQ(row(job).state, JobState::kBudgetExhausted);
  EXPECT_EQ(row(job).stop_reason, "seconds");
  EXPECT_EQ(row(job).updated_at, test::at(30));
  EXPECT_FALSE(save(job, epoch, 5));
}

TEST_F(MergeStoreTest, ABudgetIsAnAllowanceOnTopOfWhatIsSpent) {
  const JobId job = submit("ab");
  const std::uint64_t epoch = claim(job).value();
  ASSERT_TRUE(save(job, epoch, 1, {edge(0, 10)}));
  const auto pause_and_resume = [&](std::optional<std::string> budget) {
    WriteTransaction db = store_.write();
    EXPECT_TRUE(end_run(db, job, row(job).epoch, {JobState::kPaused, "paused", std::nullopt, test::at(30)}));
    EXPECT_TRUE(requeue_merge(db, job, budget, test::at(31)));
    EXPECT_FALSE(requeue_merge(db, JobId{99}, budget, test::at(31)));
    db.commit();
  };
  pause_and_resume(std::nullopt);
  EXPECT_EQ(row(job).budget, R"({"seconds":1.5})");
  EXPECT_EQ(row(job).granted_at, Spent{});
  EXPECT_EQ(row(job).stop_reason, std::nullopt);
  ASSERT_TRUE(claim(job));
  pause_and_resume(R"({"verifications":7})");
  EXPECT_EQ(row(job).budget, R"({"verifications":7})");
  EXPECT_EQ(row(job).granted_at, (Spent{0.5, 10, 1}));
}

TEST_F(MergeStoreTest, StatesWithoutAWorkerChangeOnlyFromWhatIsExpected) {
  const JobId job = submit("ab");
  WriteTransaction db = store_.write();
  EXPECT_FALSE(set_merge_state(db, job, JobState::kPaused, {JobState::kCancelled, {}, {}, test::at(20)}));
  EXPECT_TRUE(set_merge_state(db, job, JobState::kQueued, {JobState::kCancelled, {}, {}, test::at(20)}));
  EXPECT_EQ(claim_merge(db, job, test::at(21)), std::nullopt);
  EXPECT_EQ(find_merge(db, job)->state, JobState::kCancelled);
}

TEST_F(MergeStoreTest, AStartGoesOnWithWhatRanAndWhatWaited) {
  std::vector<JobId> jobs;
  for (const char* name : {"m1", "m2", "m3", "m4"}) jobs.push_back(submit(name));
  claim(jobs[0]);
  const auto epoch = claim(jobs[1]).value();
  {
    WriteTransaction db = store_.write();
    end_run(db, jobs[1], epoch, {JobState::kCompleted, std::nullopt, std::nullopt, test::at(30)});
    set_merge_state(db, jobs[3], JobState::kQueued, {JobState::kFailed, "error", "broken", test::at(30)});
    db.commit();
  }
  store_.reopen();
  WriteTransaction db = store_.write();
  EXPECT_EQ(recover_merges(db, test::at(40)), (std::vector{jobs[0], jobs[2]}));
  EXPECT_EQ(find_merge(db, jobs[1])->state, JobState::kCompleted);
  EXPECT_EQ(find_merge(db, jobs[3])->error, "broken");
}

TEST_F(MergeStoreTest, ListsArePagedAndChosenByState) {
  std::vector<JobId> jobs;
  for (const char* name : {"m1", "m2", "m3", "m4", "m5"}) jobs.push_back(submit(name));
  claim(jobs[1]);
  claim(jobs[3]);
  const ReadTransaction reader = store_.read();
  const auto first = list_merges(reader, 3);
  ASSERT_EQ(first.size(), 3U);
  EXPECT_EQ(list_merges(reader, 3, first.back().id).size(), 2U);
  const auto running = list_merges(reader, 10, std::nullopt, JobState::kRunning);
  ASSERT_EQ(running.size(), 2U);
  EXPECT_EQ(running[1].id, jobs[3]);
  EXPECT_EQ(list_merges(reader, 10, jobs[1], JobState::kRunning).size(), 1U);
  EXPECT_TRUE(list_merges(reader, 10, std::nullopt, JobState::kFailed).empty());
}

TEST_F(MergeStoreTest, TheCurveComesBackInOrder) {
  const JobId job = submit("ab");
  const std::uint64_t epoch = claim(job).value();
  std::vector<CurvePointRow> points;
  for (std::uint64_t step = 0; step < 10; ++step) {
    CurvePointRow p{step * 10, random_.unit(), random_.below(100), random_.below(100), std::nullopt, 3, random_.unit(),
                    18,        random_.unit(), std::nullopt,       "refinement"};
    if (step % 3 == 0) p.confirmed = random_.below(100);
    if (step % 2 == 0) p.certified_fraction = random_.unit();
    points.push_back(p);
  }
  WriteTransaction db = store_.write();
  CheckpointWrite checkpoint;
  checkpoint.phase = "refinement";
  checkpoint.curve_points = points;
  ASSERT_TRUE(save_checkpoint(db, job, epoch, checkpoint));
  points[9].edges = 5;  // a point of the same step takes the place of the old one
  checkpoint.curve_points = std::span(points).last(1);
  ASSERT_TRUE(save_checkpoint(db, job, epoch, checkpoint));
  db.commit();
  const ReadTransaction reader = store_.read();
  EXPECT_EQ(list_curve(reader, job, 100), points);
  EXPECT_EQ(list_curve(reader, job, 4, 30), std::vector(points.begin() + 4, points.begin() + 8));
}

TEST_F(MergeStoreTest, ADamagedPartIsTold) {
  const JobId job = submit("ab");
  ASSERT_TRUE(save(job, claim(job).value(), 1));
  WriteTransaction db = store_.write();
  db.connection().execute("UPDATE checkpoints SET bytes = CAST(bytes || x'00' AS BLOB)");
  EXPECT_THROW(load_checkpoint(db, job), StoreError);
  EXPECT_THROW(load_checkpoint_part(db, job, "state"), StoreError);
}

}  // namespace
}  // namespace mapweld
