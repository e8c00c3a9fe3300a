// random, random-candidates and degree-min: what they draw, and that all candidates come to be verified once.
#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include <gtest/gtest.h>

#include "core/merge/make_merger.h"
#include "core/merge/methods/degree_min.h"
#include "core/merge/methods/random_pairs.h"
#include "core/merge/run.h"
#include "tests/core/merge/toy_maps.h"
#include "tests/core/merge/verdict_log.h"

namespace mapweld {
namespace {

const std::vector<std::string> kRandomised{"random", "random-candidates", "degree-min"};

MergeState finished(test::ToyWorld world, const std::string& method, std::uint64_t seed) {
  world.method = method;
  MergeInput input = make_toy_merge(world);
  input.options.seed = seed;
  const auto merger = make_merger(input);
  run(*merger, {});
  return merger->state();
}

TEST(RandomMethods, EndWithTheEdgesOfBruteForce) {
  std::size_t edges = 0;
  for (std::uint32_t seed = 0; seed < 60; ++seed) {
    const MergeState expected = finished(test::toy_world(seed), "brute-force", 0);
    for (const std::string& method : kRandomised) {
      const MergeState state = finished(test::toy_world(seed), method, seed);
      EXPECT_EQ(test::edge_set(state), test::edge_set(expected)) << method << " seed " << seed;
      EXPECT_EQ(state.verifications, expected.verifications) << method << " seed " << seed;
      EXPECT_EQ(state.candidates_known, expected.candidates_known) << method << " seed " << seed;
    }
    edges += expected.edges.size();
  }
  EXPECT_GT(edges, 1000u);
}

TEST(RandomMethods, AnotherSeedIsAnotherOrderOfTheSame) {
  for (const std::string& method : kRandomised) {
    const MergeState a = finished(test::toy_world(5), method, 1), b = finished(test::toy_world(5), method, 2);
    EXPECT_EQ(finished(test::toy_world(5), method, 1), a) << method;
    EXPECT_NE(a.edges, b.edges) << method;
    EXPECT_EQ(test::edge_set(a), test::edge_set(b)) << method;
  }
}

TEST(RandomMethods, DrawEveryPairAndCountItsAttempt) {
  const test::ToyWorld world = test::toy_world(5);
  const std::uint64_t pairs = std::uint64_t{world.sizes[0]} * world.sizes[1];
  EXPECT_EQ(finished(world, "random", 3).search.attempts, pairs);
  EXPECT_EQ(finished(world, "degree-min", 3).search.attempts, pairs);
  const MergeState candidates_only = finished(world, "random-candidates", 3);
  EXPECT_EQ(candidates_only.search.attempts, candidates_only.verifications);
}

// The first attempt that was verified, over many seeds: every candidate equally often.
TEST(RandomCandidates, DrawsUniformly) {
  test::ToyWorld world;
  world.method = "random-candidates";
  world.min_votes = 8;
  MergeInput input = make_toy_merge(world);
  std::map<std::pair<VertexId, VertexId>, int> first;
  constexpr int kSeeds = 3000;
  std::uint64_t candidates = 0;
  for (int seed = 0; seed < kSeeds; ++seed) {
    input.options.seed = static_cast<std::uint64_t>(seed);
    const auto merger = make_merger(input);
    run(*merger, stop_at_verifications(1));
    const MergeState& state = merger->state();
    candidates = state.candidates_known;
    const auto pair = state.edges.empty() ? std::pair(state.rejected[0].source, state.rejected[0].target)
                                          : std::pair(state.edges[0].v, state.edges[0].u);
    ++first[std::minmax(pair.first, pair.second)];
  }
  ASSERT_GT(candidates, 5u);
  EXPECT_EQ(first.size(), candidates);
  const double expected = static_cast<double>(kSeeds) / static_cast<double>(candidates);
  for (const auto& [pair, count] : first) EXPECT_NEAR(count, expected, 6 * std::sqrt(expected));
}

// Two images of m2, one of degree 1 and one of degree 4: the former is drawn first in four of five merges.
TEST(DegreeMin, PrefersAnImageWithFewEdges) {
  MergeInput input;
  input.members = number_members({7, 6});
  std::vector<std::shared_ptr<const AppearanceVector>> vectors;
  for (int i = 0; i < 13; ++i) {
    AppearanceVector image;
    image.width_px = i + 1;
    image.height_px = 1;
    // Images 7 and 8 of m2 share their words with all of m1; those that only serve to be neighbours with none.
    for (std::uint32_t k = 0; k < 5; ++k) {
      const std::uint32_t word = i < 9 ? k : 100 + k;
      image.appearances.push_back({WordId{word}, 0, 0, 4, 0});
    }
    vectors.push_back(std::make_shared<const AppearanceVector>(std::move(image)));
  }
  input.inner_edges = {{VertexId{7}, VertexId{9}, 20},
                       {VertexId{8}, VertexId{9}, 20},
                       {VertexId{8}, VertexId{10}, 20},
                       {VertexId{8}, VertexId{11}, 20},
                       {VertexId{8}, VertexId{12}, 20}};
  input.appearances = std::make_shared<AppearanceTable>(std::move(vectors));
  input.verifier = std::make_shared<test::HashVerifier>(0.0);  // rejects, so that degrees stay
  input.options = {"degree-min", 3, VoteRule::kMin, 0};
  int of_low_degree = 0;
  constexpr int kSeeds = 3000;
  for (int seed = 0; seed < kSeeds; ++seed) {
    input.options.seed = static_cast<std::uint64_t>(seed);
    const auto merger = make_merger(input);
    run(*merger, stop_at_verifications(1));
    of_low_degree += merger->state().rejected[0].source == VertexId{7} ? 1 : 0;
  }
  EXPECT_NEAR(static_cast<double>(of_low_degree) / kSeeds, 0.8, 0.04);
}

}  // namespace
}  // namespace mapweld
