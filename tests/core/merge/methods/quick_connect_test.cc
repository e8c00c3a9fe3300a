#include "core/merge/methods/quick_connect.h"

#include <stdexcept>
#include <string>

#include <gtest/gtest.h>

#include "core/merge/make_merger.h"
#include "tests/core/merge/paper_oracle.h"
#include "tests/core/merge/toy_maps.h"
#include "tests/core/merge/verdict_log.h"

namespace mapweld {
namespace {

constexpr QuickConnect::Limits kSparse{.dense_cells = 0, .pairs_per_step = QuickConnect::kPairsPerStep};
constexpr QuickConnect::Limits kInParts{.dense_cells = QuickConnect::kDenseCells, .pairs_per_step = 5};
constexpr QuickConnect::Limits kSparseInParts{.dense_cells = 0, .pairs_per_step = 5};

MergeInput with_votes(MergeInput input) {
  const MemberPair pair = order_members(input.members);
  input.votes = std::make_shared<WordVotes>(*input.appearances, input.members[pair.m1], input.members[pair.m2]);
  return input;
}

TEST(QuickConnect, DoesEverythingInTheOrderOfThePaper) {
  std::size_t verdicts_seen = 0, edges_seen = 0;
  for (std::uint32_t seed = 0; seed < 120; ++seed) {
    const MergeInput input = make_toy_merge(test::toy_world(seed));
    const test::OracleRun expected = test::quick_connect_by_the_paper(input);
    const auto merger = make_merger(input);
    EXPECT_EQ(merger->words_total(), expected.words.size());
    EXPECT_EQ(test::log_verdicts(*merger), test::without_votes_of_rejected(expected.verdicts)) << "seed " << seed;
    EXPECT_TRUE(merger->done());
    EXPECT_EQ(merger->state().candidates_known, expected.verdicts.size());
    verdicts_seen += expected.verdicts.size();
    edges_seen += merger->state().edges.size();
  }
  EXPECT_GT(verdicts_seen, 3000u);  // the worlds are not trivial
  EXPECT_GT(edges_seen, 1000u);
}

TEST(QuickConnect, IsTheSameWithASparseMatrixAndWordsInParts) {
  for (std::uint32_t seed = 0; seed < 60; ++seed) {
    const MergeInput input = with_votes(make_toy_merge(test::toy_world(seed)));
    QuickConnect usual(input);
    const auto expected = test::log_verdicts(usual);
    for (const QuickConnect::Limits& limits : {kSparse, kInParts, kSparseInParts}) {
      QuickConnect other(input, limits);
      EXPECT_EQ(test::log_verdicts(other), expected) << "seed " << seed;
      EXPECT_EQ(other.state().edges, usual.state().edges);
      EXPECT_EQ(other.state().rejected, usual.state().rejected);
    }
  }
}

TEST(QuickConnect, FillsTheSimilarityMatrix) {
  const MergeInput input = with_votes(make_toy_merge(test::toy_world(19)));
  QuickConnect merger(input);
  run(merger, {});
  std::vector<std::uint32_t> row;
  for (std::uint32_t i = 0; i < input.votes->rows(); ++i) {
    votes_of_row(*input.votes, i, input.options.votes, row);
    for (std::uint32_t j = 0; j < input.votes->columns(); ++j) {
      EXPECT_EQ(merger.state().search.similarity.at(i, j), row[j]);
    }
  }
}

TEST(QuickConnect, InsertsAtMostOneEdgeASourceWhileExploring) {
  for (std::uint32_t seed = 0; seed < 40; ++seed) {
    const auto merger = make_merger(make_toy_merge(test::toy_world(seed)));
    run(*merger, stop_when_merger([](const Merger& m) { return m.state().phase == MergePhase::kRefinement; },
                                  StopReason::kPaused));
    const MemberPair pair = order_members(merger->input().members);
    const auto& m2 = merger->input().members[pair.m2].vertices;
    std::vector<VertexId> sources;
    for (const MergeEdge& e : merger->state().edges) {
      sources.push_back(std::binary_search(m2.begin(), m2.end(), e.u) ? e.u : e.v);
    }
    std::sort(sources.begin(), sources.end());
    EXPECT_EQ(std::adjacent_find(sources.begin(), sources.end()), sources.end());
  }
}

TEST(QuickConnect, MakesAtMostOneVerificationAStep) {
  const auto merger = make_merger(make_toy_merge(test::toy_world(19)));
  std::uint64_t before = 0, steps = 0;
  run(*merger, {}, [&](const Merger& m) {
    EXPECT_LE(m.state().verifications, before + 1);
    before = m.state().verifications;
    EXPECT_EQ(m.state().step, ++steps);
  });
}

TEST(QuickConnect, KeepsTheMergedGraph) {
  const MergeInput input = make_toy_merge(test::toy_world(19));
  const auto merger = make_merger(input);
  run(*merger, {},
      [&](const Merger& m) { ASSERT_EQ(m.graph().edges(), input.inner_edges.size() + m.state().edges.size()); });
  ASSERT_FALSE(merger->state().edges.empty());
  for (const MergeEdge& e : merger->state().edges) {
    EXPECT_LT(e.u, e.v);
    EXPECT_TRUE(merger->graph().has_edge(e.u, e.v));
    const auto a = input.appearances->appearances(e.u), b = input.appearances->appearances(e.v);
    EXPECT_EQ(e.verification, input.verifier->verify(*a, *b));
  }
}

TEST(QuickConnect, OfMapsWithoutACommonWordIsDoneAtOnce) {
  test::ToyWorld world;
  world.sizes = {5, 0};
  const auto merger = make_merger(make_toy_merge(world));
  EXPECT_TRUE(merger->done());
  EXPECT_THROW(merger->step(), std::logic_error);
}

TEST(QuickConnect, ChangesNothingWhenAnImageCannotBeRead) {
  class Failing final : public AppearanceSource {
   public:
    explicit Failing(std::shared_ptr<const AppearanceSource> inner) : inner_(std::move(inner)) {}
    std::shared_ptr<const AppearanceVector> appearances(VertexId v) const override {
      if (fails) throw std::runtime_error("the disk is gone");
      return inner_->appearances(v);
    }
    bool fails = false;

   private:
    std::shared_ptr<const AppearanceSource> inner_;
  };
  MergeInput input = make_toy_merge(test::toy_world(19));
  const auto failing = std::make_shared<Failing>(input.appearances);
  const auto expected = make_merger(input);
  run(*expected, {});
  input.appearances = failing;
  const auto merger = make_merger(input);
  while (!merger->done()) {
    const MergeState before = merger->state();
    failing->fails = true;
    try {
      merger->step();
    } catch (const std::runtime_error&) {
      EXPECT_EQ(merger->state(), before);
      failing->fails = false;
      merger->step();
    }
  }
  EXPECT_EQ(merger->state(), expected->state());
}

TEST(MakeMerger, RefusesWhatCannotBeMerged) {
  MergeInput input = make_toy_merge(test::ToyWorld{});
  input.options.method = "guess";
  EXPECT_THROW(make_merger(input), std::invalid_argument);
  input = make_toy_merge(test::ToyWorld{});
  input.options.min_votes = 0;
  EXPECT_THROW(make_merger(input), std::invalid_argument);
  input = make_toy_merge(test::ToyWorld{});
  input.members[1].vertices[0] = input.members[0].vertices[0];
  EXPECT_THROW(make_merger(input), std::invalid_argument);
  test::ToyWorld alone;
  alone.sizes = {5};
  EXPECT_THROW(make_merger(make_toy_merge(alone)), std::invalid_argument);
}

}  // namespace
}  // namespace mapweld
