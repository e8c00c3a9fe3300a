#include "core/merge/methods/alignment.h"

#include <algorithm>
#include <random>
#include <set>

#include <gtest/gtest.h>

#include "core/errors.h"
#include "core/merge/make_merger.h"
#include "core/merge/run.h"
#include "tests/core/merge/toy_maps.h"
#include "tests/core/merge/verdict_log.h"

namespace mapweld {
namespace {

// So lenient that toy maps have alignments of every kind, and in steps so small that they stop anywhere.
Alignment::Limits toy_limits() {
  Alignment::Limits limits;
  limits.sequence.min_score = 8;
  limits.sequence.skip_penalty = limits.sequence.repeat_penalty = 2;
  limits.level_percent = 50;
  limits.min_images = 2;
  limits.halo = 1;
  limits.pairs_per_step = 9;
  return limits;
}

MergeInput with_votes(MergeInput input) {
  const MemberPair pair = order_members(input.members);
  input.votes = std::make_shared<WordVotes>(*input.appearances, input.members[pair.m1], input.members[pair.m2]);
  return input;
}

MergeInput toy_input(std::uint32_t seed) {
  test::ToyWorld world = test::toy_world(seed);
  world.method = "alignment";
  return with_votes(make_toy_merge(world));
}

// Votes as a test wants them: one word for each pair of images, as often as the pair shall have votes.
class GivenVotes final : public VoteSource {
 public:
  GivenVotes(std::uint32_t rows, std::uint32_t columns)
      : columns_(columns), rows_(rows), row_words_(rows), row_signatures_(rows) {}
  void set(std::uint32_t row, std::uint32_t column, std::uint16_t votes) {
    const auto word = static_cast<std::uint32_t>(words_.size());
    words_.push_back(WordId{word});
    row_postings_.push_back({std::vector(votes, VertexId{row}), std::vector<VoteSignature>(votes)});
    column_postings_.push_back({std::vector(votes, VertexId{column}), std::vector<VoteSignature>(votes)});
    row_words_[row].push_back({word, votes});
    row_signatures_[row].resize(row_signatures_[row].size() + votes);
  }
  std::uint32_t rows() const override { return rows_; }
  std::uint32_t columns() const override { return columns_; }
  std::span<const WordId> words() const override { return words_; }
  PostingSpan row_postings(std::uint32_t word) const override { return row_postings_[word]; }
  PostingSpan column_postings(std::uint32_t word) const override { return column_postings_[word]; }
  std::span<const RowWord> row_words(std::uint32_t row) const override { return row_words_[row]; }
  std::span<const VoteSignature> row_signatures(std::uint32_t row) const override { return row_signatures_[row]; }
  std::uint64_t fingerprint(VoteRule) const override { return words_.size(); }

 private:
  std::uint32_t columns_, rows_;
  std::vector<WordId> words_;
  std::vector<PostingList> row_postings_, column_postings_;
  std::vector<std::vector<RowWord>> row_words_;
  std::vector<std::vector<VoteSignature>> row_signatures_;
};

// m1 is the first member, its columns are vertices 0 ..; m2's rows come after them.
constexpr std::uint32_t kColumns = 40, kRows = 30;

MergeInput given_input(std::shared_ptr<const GivenVotes> votes) {
  MergeInput input;
  input.members = number_members({kColumns, kRows});
  std::vector<std::shared_ptr<const AppearanceVector>> vectors;
  for (std::uint32_t v = 0; v < kColumns + kRows; ++v) {
    AppearanceVector image;
    image.width_px = static_cast<int>(v) + 1;
    vectors.push_back(std::make_shared<const AppearanceVector>(std::move(image)));
  }
  input.appearances = std::make_shared<AppearanceTable>(std::move(vectors));
  input.verifier = std::make_shared<test::HashVerifier>(1.0);
  input.votes = std::move(votes);
  input.options = {"alignment", 10, VoteRule::kMin, 1};
  return input;
}

using Cell = std::pair<std::uint32_t, std::uint32_t>;

std::vector<Cell> verified_cells(Merger& merger) {
  std::vector<Cell> cells;
  for (const test::OracleVerdict& v : test::log_verdicts(merger)) {
    cells.emplace_back(to_index(v.source) - kColumns, to_index(v.target));
  }
  return cells;
}

TEST(Alignment, VerifiesAlongSequencesInBothDirectionsAndNotLookAlikes) {
  const auto votes = std::make_shared<GivenVotes>(kRows, kColumns);
  std::vector<Cell> expected;
  for (std::uint32_t k = 0; k < 9; ++k) votes->set(2 + k, 3 + k, 70);
  for (const std::uint32_t k : {0u, 8u, 4u, 2u, 6u, 1u, 3u, 5u, 7u}) expected.emplace_back(2 + k, 3 + k);
  for (std::uint32_t k = 0; k < 7; ++k) votes->set(15 + k, 30 - k, 60);
  for (const std::uint32_t k : {0u, 6u, 3u, 1u, 4u, 2u, 5u}) expected.emplace_back(15 + k, 30 - k);
  votes->set(5, 35, 60000);                                           // one image alike
  for (std::uint32_t k = 0; k < 8; ++k) votes->set(25, 2 + k, 500);   // one image like a whole stretch
  for (std::uint32_t k = 0; k < 7; ++k) votes->set(22 + k, 39, 500);  // and the other way round
  votes->set(6, 9, 11);  // weak, but beside an alignment: the halos come last
  votes->set(16, 31, 12);
  votes->set(1, 12, 11);  // weak, and beside none
  expected.emplace_back(6, 9);
  expected.emplace_back(16, 31);
  const auto merger = make_merger(given_input(votes));
  EXPECT_EQ(verified_cells(*merger), expected);
  EXPECT_EQ(merger->state().candidates_known, expected.size());
}

TEST(Alignment, TakesItsSurroundingsOutOfTheMatrix) {
  // The second sequence lies in the halo of the first but for its last two pairs, which are too few for another one.
  const auto votes = std::make_shared<GivenVotes>(kRows, kColumns);
  for (std::uint32_t k = 0; k < 9; ++k) votes->set(2 + k, 3 + k, 70);
  for (std::uint32_t k = 0; k < 9; ++k) votes->set(2 + k, 7 + k, 60);
  votes->set(6, 15, 11);  // in the halo of the second one alone
  std::vector<Cell> expected;
  for (const std::uint32_t k : {0u, 8u, 4u, 2u, 6u, 1u, 3u, 5u, 7u}) expected.emplace_back(2 + k, 3 + k);
  for (std::uint32_t k = 0; k < 7; ++k) expected.emplace_back(2 + k, 7 + k);
  const auto merger = make_merger(given_input(votes));
  EXPECT_EQ(verified_cells(*merger), expected);
}

TEST(Alignment, TakesNoAccountOfWhatIsUsual) {
  // Everything looks like everything: 100 votes all over. Only what stands out is a sequence.
  const auto votes = std::make_shared<GivenVotes>(kRows, kColumns);
  std::set<Cell> expected;
  for (std::uint32_t row = 0; row < kRows; ++row) {
    for (std::uint32_t column = 0; column < kColumns; ++column) {
      const bool is_seen_twice = row >= 4 && row < 14 && column == row + 10;
      votes->set(row, column, is_seen_twice ? 260 : 100);
      if (is_seen_twice) expected.insert({row, column});
    }
  }
  Alignment::Limits limits;
  limits.halo = 0;
  Alignment merger(given_input(votes), limits);
  const std::vector<Cell> cells = verified_cells(merger);
  EXPECT_EQ(std::set<Cell>(cells.begin(), cells.end()), expected);
  EXPECT_EQ(cells.size(), expected.size());
}

TEST(Alignment, VerifiesCandidatesOfBruteForceAndEachOnce) {
  std::size_t subset_edges = 0, all_edges = 0, verified = 0, candidates = 0;
  for (std::uint32_t seed = 0; seed < 140; ++seed) {
    MergeInput input = toy_input(seed);
    Alignment alignment(input, toy_limits());
    input.options.method = "brute-force";
    const auto brute = make_merger(std::move(input));
    std::set<std::pair<VertexId, VertexId>> all;
    for (const test::OracleVerdict& v : test::log_verdicts(*brute)) all.emplace(v.source, v.target);
    std::set<std::pair<VertexId, VertexId>> once;
    for (const test::OracleVerdict& v : test::log_verdicts(alignment)) {
      EXPECT_TRUE(once.emplace(v.source, v.target).second) << "seed " << seed;
      EXPECT_TRUE(all.contains({v.source, v.target})) << "seed " << seed;
    }
    EXPECT_EQ(alignment.state().candidates_known, once.size());
    EXPECT_EQ(alignment.state().verifications, once.size());
    const auto edges = test::edge_set(alignment.state()), more = test::edge_set(brute->state());
    EXPECT_TRUE(std::includes(more.begin(), more.end(), edges.begin(), edges.end())) << "seed " << seed;
    subset_edges += edges.size();
    all_edges += more.size();
    verified += once.size();
    candidates += all.size();
  }
  EXPECT_GT(subset_edges, 1000u);  // neither nothing nor everything
  EXPECT_LT(subset_edges, all_edges);
  EXPECT_GT(verified, 2000u);
  EXPECT_LT(verified, candidates);
}

TEST(Alignment, KeepsTheSimilarityMatrix) {
  const MergeInput input = toy_input(19);
  Alignment merger(input, toy_limits());
  run(merger, {});
  std::vector<std::uint32_t> row;
  for (std::uint32_t i = 0; i < input.votes->rows(); ++i) {
    votes_of_row(*input.votes, i, input.options.votes, row);
    for (std::uint32_t j = 0; j < input.votes->columns(); ++j) {
      EXPECT_EQ(merger.state().search.similarity.at(i, j), row[j] >= input.options.min_votes ? row[j] : 0);
    }
  }
}

TEST(Alignment, VotesBeforeItVerifiesAndVerifiesOnceAStep) {
  const auto merger = make_merger(toy_input(19));
  std::uint64_t before = 0, steps = 0;
  MergePhase phase = merger->state().phase;
  EXPECT_EQ(phase, MergePhase::kVoting);
  run(*merger, {}, [&](const Merger& m) {
    EXPECT_EQ(m.state().step, ++steps);
    EXPECT_GE(m.state().phase, phase);
    EXPECT_EQ(m.state().verifications, before + (phase == MergePhase::kVerification ? 1 : 0));
    before = m.state().verifications;
    phase = m.state().phase;
  });
}

TEST(Alignment, IsDoneAtOnceWithoutImages) {
  for (const std::vector<std::uint32_t>& sizes : {std::vector<std::uint32_t>{5, 0}, {0, 0}}) {
    test::ToyWorld world;
    world.sizes = sizes;
    world.method = "alignment";
    EXPECT_TRUE(make_merger(make_toy_merge(world))->done());
  }
}

// The state's own limits: at every step of many merges, also between two alignments.
TEST(Alignment, GoesOnFromEveryStep) {
  for (std::uint32_t seed = 0; seed < 60; ++seed) {
    const MergeInput input = toy_input(seed);
    const auto whole = make_merger(input);
    run(*whole, {});
    auto merger = make_merger(input);
    while (!merger->done()) {
      merger->step();
      const auto other = make_merger(input, merger->state());
      ASSERT_EQ(other->state(), merger->state());
      merger = make_merger(input, merger->state());
    }
    ASSERT_EQ(merger->state(), whole->state()) << "seed " << seed;
  }
}

TEST(Alignment, RefusesAStateWithOtherAlignments) {
  const MergeInput input = toy_input(19);
  const auto merger = make_merger(input);
  run(*merger, stop_when_merger(
                   [](const Merger& m) {
                     return m.state().phase == MergePhase::kVoting && m.state().search.postponed.size() > 3;
                   },
                   StopReason::kPaused));
  const MergeState good = merger->state();
  ASSERT_EQ(good.phase, MergePhase::kVoting);
  EXPECT_NO_THROW(make_merger(input, good));
  const auto expect_refused = [&](auto&& damage) {
    MergeState state = good;
    damage(state);
    EXPECT_THROW(make_merger(input, state), FormatError);
  };
  expect_refused([](MergeState& s) { s.search.postponed.pop_back(); });
  expect_refused([](MergeState& s) { std::swap(s.search.postponed[0], s.search.postponed[1]); });
  expect_refused([](MergeState& s) { ++s.candidates_known; });
  expect_refused([](MergeState& s) { s.search.word_next_row = 1; });
  expect_refused([](MergeState& s) { s.search.word_next_row = 4000000000u; });
  expect_refused([](MergeState& s) { --s.search.next_row; });
  expect_refused([](MergeState& s) { s.search.similarity = SimilarityMatrix::dense(1, 1); });
  expect_refused([](MergeState& s) { s.phase = MergePhase::kVerification; });
  expect_refused([](MergeState& s) { s.phase = MergePhase::kRefinement; });
}

}  // namespace
}  // namespace mapweld
