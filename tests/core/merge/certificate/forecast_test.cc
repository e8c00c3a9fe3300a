#include "core/merge/certificate/forecast.h"

#include <algorithm>
#include <set>
#include <string_view>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "core/merge/make_merger.h"
#include "core/merge/run.h"
#include "tests/core/merge/toy_maps.h"

namespace mapweld {
namespace {

using PairSet = std::set<std::pair<VertexId, VertexId>>;

TEST(Forecast, IsOfWhatHasNoVerdictAndOfWhatIsWithheld) {
  for (const std::string_view method : {"quickconnect", "random-candidates", "spectral"}) {
    const auto merger = make_merger(make_toy_merge(test::large_toy_world(3, method)));
    run(*merger, stop_when_merger(
                     [](const Merger& m) { return m.open_candidates().has_value() && m.state().verifications >= 60; },
                     StopReason::kPaused));
    PairSet expected;
    const std::vector<Candidate> left = merger->open_candidates().value();
    for (const Candidate& c : left) expected.insert(std::minmax(c.source, c.target));
    std::vector<EdgeStanding> standings(merger->state().edges.size());
    AppearanceGraph confirmed(merger->graph().vertices(), merger->input().inner_edges);
    for (std::size_t e = 0; e < standings.size(); ++e) {
      const MergeEdge& edge = merger->state().edges[e];
      if (e % 3 == 0) {
        standings[e] = {false, 0.5};
        expected.emplace(edge.u, edge.v);
      } else {
        confirmed.add_edge(edge.u, edge.v, 1);
      }
    }
    PairSet told;
    const auto open = Forecast().open(*merger, confirmed, standings);
    ASSERT_TRUE(open) << method;
    for (const OpenCandidate& c : *open) {
      EXPECT_TRUE(told.emplace(c.u, c.v).second) << "twice";
      EXPECT_GT(c.chance, 0);
      EXPECT_LT(c.chance, 1);
    }
    EXPECT_EQ(told, expected) << method;
  }
}

TEST(Forecast, SaysNothingWhileThereAreVotesToBeCounted) {
  const auto merger = make_merger(make_toy_merge(test::large_toy_world(1, "spectral")));
  ASSERT_FALSE(merger->open_candidates());
  EXPECT_FALSE(Forecast().open(*merger, merger->graph(), {}));
  run(*merger, {});
  EXPECT_TRUE(Forecast().open(*merger, merger->graph(), {})->empty()) << "done";
}

// Worlds in which every candidate passes with the same chance, wherever it lies: what was learnt elsewhere gives way to
// what these merges say.
TEST(Forecast, ExpectsAboutAsManyEdgesAsCome) {
  double told = 0, came = 0;
  for (std::uint32_t seed = 0; seed < 30; ++seed) {
    const MergeInput input = make_toy_merge(test::large_toy_world(200 + seed, "random-candidates"));
    const auto whole = make_merger(input);
    run(*whole, {});
    const auto merger = make_merger(input);
    run(*merger, stop_at_verifications(whole->state().verifications / 2));
    const auto open = Forecast().open(*merger, merger->graph(), {});
    if (!open) continue;
    for (const OpenCandidate& c : *open) told += c.chance;
    came += static_cast<double>(whole->state().edges.size() - merger->state().edges.size());
  }
  EXPECT_GT(came, 500);
  EXPECT_NEAR(told / came, 1, 0.15);
}

TEST(Forecast, IsAFunctionOfTheStateHoweverOftenItWasAsked) {
  for (const std::string_view method : {"spectral", "degree-min"}) {
    const MergeInput input = make_toy_merge(test::large_toy_world(5, method));
    const auto merger = make_merger(input);
    Forecast follows;
    for (std::uint64_t next = 20; !merger->done(); next += 20) {
      run(*merger, stop_at_verifications(next));
      const auto followed = follows.open(*merger, merger->graph(), {});
      const auto fresh = Forecast().open(*make_merger(input, merger->state()), merger->graph(), {});
      ASSERT_EQ(followed.has_value(), fresh.has_value());
      if (!followed) continue;
      ASSERT_EQ(followed->size(), fresh->size());
      for (std::size_t i = 0; i < fresh->size(); ++i) {
        ASSERT_EQ(std::pair((*followed)[i].u, (*followed)[i].v), std::pair((*fresh)[i].u, (*fresh)[i].v));
        ASSERT_EQ((*followed)[i].chance, (*fresh)[i].chance) << method << " at " << next;
        ASSERT_EQ((*followed)[i].place, (*fresh)[i].place);
      }
    }
  }
}

}  // namespace
}  // namespace mapweld
