// A merge's state against the rows beside it: what is whole passes, and each thing that does not fit is named.
#include "schema/merges/merge_state_check.h"

#include <functional>
#include <optional>
#include <utility>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "schema/store_check.h"
#include "tests/support/temp_store.h"

namespace mapweld {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

// Members "a", vertices 0 to 5, and "b", vertices 6 to 11.
class MergeStateCheck : public testing::Test {
 protected:
  void SetUp() override {
    test::Random random(5);
    for (const MapId map : {a_, b_}) {
      for (int v = 0; v < 6; ++v) {
        test::add_vertex(store_, map, vocabulary_, std::to_string(v), test::random_appearances(random, 20, 1'000));
      }
    }
    state_.method = "quickconnect";
    state_.vertices = 12;
    state_.step = 40;
    state_.phase = MergePhase::kExploration;
    state_.verifications = 5;
    const auto edge = [&](std::uint32_t u, std::uint32_t v, std::uint64_t verifications) {
      state_.edges.push_back(
          {VertexId{u}, VertexId{v}, 9, test::random_verification(random, 12, 20, 20), verifications});
    };
    edge(1, 7, 2);
    edge(0, 8, 3);
    edge(5, 11, 5);
    state_.rejected.push_back({VertexId{6}, VertexId{0}, Reason::kUnsupported, 3, 0, 9});
    state_.rejected.push_back({VertexId{2}, VertexId{9}, Reason::kUnsupported, 3, 0, 9});
  }

  JobId store_merge(const MergeState& state) {
    WriteTransaction db = store_.write();
    const MapId merged = insert_merged_map(db, test::new_map("ab", vocabulary_), std::vector{a_, b_});
    const JobId job = insert_merge(db, {merged, "quickconnect", 7, "{}", "{}", test::at(0)});
    test::save_state(db, job, claim_merge(db, job, test::at(1)).value(), state);
    db.commit();
    return job;
  }

  // What is found of a state that was stored as it is.
  std::vector<std::string> found_in(const std::function<void(MergeState&)>& change) {
    MergeState state = state_;
    change(state);
    const JobId job = store_merge(state);
    const std::vector<std::string> found = check_merge_state(store_.read(), *find_merge(store_.read(), job));
    WriteTransaction db = store_.write();
    delete_merge(db, job);
    db.commit();
    return found;
  }

  test::TempStore store_;
  VocabularyId vocabulary_ = test::add_vocabulary(store_);
  MapId a_ = test::add_map(store_, "a", vocabulary_);
  MapId b_ = test::add_map(store_, "b", vocabulary_);
  MergeState state_;
};

TEST_F(MergeStateCheck, AWholeStateAndAMergeWithoutOnePass) {
  EXPECT_THAT(found_in([](MergeState&) {}), IsEmpty());
  WriteTransaction db = store_.write();
  const MapId merged = insert_merged_map(db, test::new_map("ab", vocabulary_), std::vector{a_, b_});
  const JobId job = insert_merge(db, {merged, "quickconnect", 7, "{}", "{}", test::at(0)});
  EXPECT_THAT(check_merge_state(db, *find_merge(db, job)), IsEmpty());
}

TEST_F(MergeStateCheck, AStateOfBeforeItsMembersHaveGrownPasses) {
  const JobId job = store_merge(state_);
  test::Random random(6);
  test::add_vertex(store_, a_, vocabulary_, "new", test::random_appearances(random, 20, 1'000));
  WriteTransaction db = store_.write();
  ASSERT_EQ(extend_merged_map(db, find_merge(db, job)->map), 1U);
  EXPECT_THAT(check_merge_state(db, *find_merge(db, job)), IsEmpty());
}

TEST_F(MergeStateCheck, AStateThatContradictsItselfIsNamed) {
  const std::vector<std::pair<std::function<void(MergeState&)>, std::string>> cases = {
      {[](MergeState& s) { s.verifications = 6; }, "6 verifications, and its verdicts are 5"},
      {[](MergeState& s) { s.rejected.pop_back(); }, "5 verifications, and its verdicts are 4"},
      {[](MergeState& s) { s.inherited_edges = 4; }, "took over more verdicts than it has"},
      {[](MergeState& s) { s.inherited_rejected = 3; }, "took over more verdicts than it has"},
      {[](MergeState& s) { std::swap(s.edges[1].verifications, s.edges[2].verifications); }, "order"},
      {[](MergeState& s) { s.edges[2].verifications = 6; }, "5 and 11"},
      {[](MergeState& s) { s.vertices = 13; }, "about 13 vertices, its members have 12"},
      {[](MergeState& s) { s.vertices = 11; }, "vertex that its members do not have: 5 and 11"},
      {[](MergeState& s) { s.rejected[0].source = VertexId{12}; }, "vertex that its members do not have: 12 and 0"},
      {[](MergeState& s) { s.rejected[0].source = VertexId{4}; }, "two vertices of one member: 4 and 0"},
      {[](MergeState& s) { s.edges[0].v = VertexId{2}; }, "two vertices of one member: 1 and 2"},
      {[](MergeState& s) { s.rejected[1] = s.rejected[0]; }, "two verdicts about one pair: 0 and 6"},
      {[](MergeState& s) { s.rejected[0].source = VertexId{8}; }, "two verdicts about one pair: 0 and 8"},
      {[](MergeState& s) { s.method = "spectral"; }, "one of spectral, its row says quickconnect"},
  };
  for (const auto& [change, says] : cases) EXPECT_THAT(found_in(change), ElementsAre(HasSubstr(says)));
}

TEST_F(MergeStateCheck, ARowThatSaysSomethingElseIsNamed) {
  const JobId job = store_merge(state_);
  const std::vector<std::pair<std::string, std::string>> cases = {
      {"UPDATE merges SET step = 41", "40 steps, its row 41"},
      {"UPDATE merges SET verifications = 4", "5 verifications, its row 4"},
      {"UPDATE merges SET edges = 4", "3 edges, its row 4"},
      {"UPDATE merges SET phase = 'done'", "in exploration, its row in done"},
      {"DELETE FROM edges; DELETE FROM checkpoints; UPDATE maps SET edges = 0", "it was written, and is not there"},
      // An edge is gone, and every counter was put right: only the state remembers.
      {"DELETE FROM edges WHERE u = 0; UPDATE maps SET edges = 2 WHERE kind = 'merged'; UPDATE merges SET edges = 2",
       "counts 3 edges, of which 2 are stored"},
      {"UPDATE edges SET u = 2, v = 9 WHERE u = 0", "two verdicts about one pair: 2 and 9"},
      {"UPDATE edges SET v = 5 WHERE u = 0", "two vertices of one member: 0 and 5"},
      {"UPDATE edges SET verifications = 2 WHERE u = 0", "order in which they stand: 0 and 8"},
      {"DELETE FROM checkpoints WHERE part = 'queue'", "queue"},
      {"UPDATE checkpoints SET crc32 = crc32 + 1 WHERE part = 'queue'", "queue"},
  };
  for (const auto& [damage, says] : cases) {
    WriteTransaction db = store_.write();
    db.connection().execute(damage);
    const std::vector<Finding> found = check_store(db).findings;
    const auto is_told = testing::AllOf(testing::Field(&Finding::where, where_of_checkpoint(job)),
                                        testing::Field(&Finding::what, HasSubstr(says)),
                                        testing::Field(&Finding::what, HasSubstr("restart the merge")));
    EXPECT_THAT(found, ElementsAre(is_told)) << damage;
  }
}

}  // namespace
}  // namespace mapweld
