#include "server/evaluation/limit.h"

#include <cstdint>
#include <vector>

#include <gtest/gtest.h>

#include "core/merge/make_merger.h"
#include "tests/core/merge/toy_maps.h"

namespace mapweld::server::evaluation {
namespace {

const std::vector<double> kLevels{.5, .9, .95, .99};

// A large toy world merged.
struct Merged {
  MergeInput input = test::make_toy_merge(test::large_toy_world(3, "quickconnect"));
  RecordedRun run = record_run(input);
  FinalComponent component{input, run.edges};
};

TEST(Limit, BoundsEveryOrderAndTheClairvoyantIsAheadOfIt) {
  const Merged merged;
  const Limit limit = limit_of(merged.component, merged.run.edges, {.levels = kLevels});
  ASSERT_EQ(limit.levels.size(), kLevels.size());
  RunCurve quick_connect(merged.component, merged.run);
  for (std::size_t l = 0; l < kLevels.size(); ++l) {
    const LevelLimit& of_level = limit.levels[l];
    ASSERT_TRUE(of_level.clairvoyant.has_value());
    EXPECT_GE(of_level.clairvoyant->connectivity, kLevels[l] * merged.component.final_connectivity() * (1 - 1e-8));
    EXPECT_LE(of_level.least_edges, of_level.clairvoyant->edges);
    EXPECT_LE(of_level.clairvoyant->edges, quick_connect.edges_to(kLevels[l]).value());
    EXPECT_GT(of_level.least_edges, 0u);
  }
  ASSERT_GT(limit.bound.size(), 8u);
  EXPECT_EQ(limit.bound.front().edges, 1u);
  EXPECT_NEAR(limit.bound.back().connectivity, merged.component.final_connectivity(), 1e-9);
  for (std::size_t i = 0; i < limit.bound.size(); ++i) {
    const BoundPoint& point = limit.bound[i];
    if (i > 0) {
      EXPECT_GT(point.edges, limit.bound[i - 1].edges);
      EXPECT_GE(point.connectivity, limit.bound[i - 1].connectivity);
    }
    EXPECT_GE(point.connectivity, quick_connect.at(point.edges).connectivity * (1 - 1e-8));
    for (const CurvePoint& picked : limit.clairvoyant) {
      if (picked.edges > point.edges) break;
      EXPECT_GE(point.connectivity, picked.connectivity * (1 - 1e-8));
    }
  }
}

TEST(Limit, IsTheSameForAnyNumberOfThreads) {
  const Merged merged;
  const auto limit_by = [&](int threads) {
    return limit_of(merged.component, merged.run.edges, {.levels = kLevels, .threads = threads});
  };
  const Limit one = limit_by(1), three = limit_by(3);
  ASSERT_EQ(one.bound.size(), three.bound.size());
  for (std::size_t i = 0; i < one.bound.size(); ++i) {
    EXPECT_EQ(one.bound[i].edges, three.bound[i].edges);
    EXPECT_EQ(one.bound[i].connectivity, three.bound[i].connectivity);
  }
  for (std::size_t l = 0; l < kLevels.size(); ++l) {
    EXPECT_EQ(one.levels[l].clairvoyant->edges, three.levels[l].clairvoyant->edges);
    EXPECT_EQ(one.levels[l].least_edges, three.levels[l].least_edges);
  }
}

TEST(Limit, OfNothingIsNothing) {
  Merged merged;
  const FinalComponent alone(merged.input, {});
  std::uint64_t told = 0, total = 0;
  const Limit limit = limit_of(alone, {}, {.levels = kLevels}, [&](std::uint64_t done, std::uint64_t of) {
    told = done;
    total = of;
  });
  EXPECT_EQ(told, total);
  EXPECT_TRUE(limit.bound.empty());
  for (const LevelLimit& level : limit.levels) {
    ASSERT_TRUE(level.clairvoyant.has_value());
    EXPECT_EQ(level.clairvoyant->edges, 0u);
    EXPECT_EQ(level.least_edges, 0u);
    EXPECT_FALSE(to_clairvoyant(level, 5).has_value());
  }
}

TEST(Limit, TellsTheRatio) {
  LevelLimit level{.level = 0.9, .clairvoyant = CurvePoint{.edges = 4}, .least_edges = 3};
  EXPECT_EQ(to_clairvoyant(level, 10), 2.5);
  level.clairvoyant.reset();
  EXPECT_EQ(to_clairvoyant(level, 10), std::nullopt);
}

}  // namespace
}  // namespace mapweld::server::evaluation
