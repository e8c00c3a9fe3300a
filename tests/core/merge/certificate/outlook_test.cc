#include "core/merge/certificate/outlook.h"

#include <memory>
#include <vector>

#include <gtest/gtest.h>

#include "core/graph/algebraic_connectivity.h"
#include "core/merge/make_merger.h"
#include "core/merge/run.h"
#include "tests/core/merge/toy_maps.h"

namespace mapweld {
namespace {

// Steps `merger` until all votes are in.
void vote(Merger& merger) {
  run(merger, stop_when_merger([](const Merger& m) { return m.open_candidates().has_value(); }, StopReason::kPaused));
}

TEST(Outlook, TellsNothingBeforeAnythingIsJoined) {
  int joined_later = 0;
  for (std::uint32_t seed = 0; seed < 12; ++seed) {
    const auto merger = make_merger(make_toy_merge(test::large_toy_world(seed, "spectral")));
    Outlook outlook;
    EXPECT_FALSE(outlook.certificate(*merger)) << "votes are still to be counted";
    EXPECT_FALSE(outlook.estimate(*merger));
    vote(*merger);
    // Each candidate leads out of its own map, so that none lies within the largest component.
    EXPECT_FALSE(outlook.certificate(*merger)) << "seed " << seed;
    EXPECT_FALSE(outlook.estimate(*merger));
    run(*merger, stop_at_verifications(60));
    const auto certificate = outlook.certificate(*merger);
    EXPECT_EQ(certificate.has_value(), outlook.estimate(*merger).has_value());
    if (certificate && certificate->open_within > 0) ++joined_later;
    run(*merger, {});
    EXPECT_EQ(outlook.certificate(*merger).value().certified_fraction, 1);
    EXPECT_EQ(outlook.estimate(*merger).value().fraction, 1);
  }
  EXPECT_GT(joined_later, 8);
}

TEST(Outlook, SpeaksOfConfirmedEdgesAndTakesTheOthersForOpen) {
  for (std::uint32_t seed = 0; seed < 6; ++seed) {
    const auto merger = make_merger(make_toy_merge(test::large_toy_world(seed, "random-candidates")));
    vote(*merger);
    run(*merger, stop_at_verifications(120));
    const std::vector<MergeEdge>& edges = merger->state().edges;
    ASSERT_GT(edges.size(), 10u);
    const auto every_other = [](const Merger& m) {
      std::vector<EdgeStanding> standings(m.state().edges.size());
      for (std::size_t e = 0; e < standings.size(); e += 2) standings[e] = {false, 0.3};
      return standings;
    };
    AppearanceGraph confirmed(merger->graph().vertices(), merger->input().inner_edges);
    std::vector<OpenCandidate> open;
    for (std::size_t e = 0; e < edges.size(); ++e) {
      if (e % 2 == 0) {
        open.push_back({edges[e].u, edges[e].v});
      } else {
        confirmed.add_edge(edges[e].u, edges[e].v, 1);
      }
    }
    const std::vector<Candidate> left = merger->open_candidates().value();
    for (const Candidate& c : left) open.push_back({c.source, c.target});
    const Certificate expected = certify(confirmed, open), told = Outlook(every_other).certificate(*merger).value();
    EXPECT_EQ(told.certified_fraction, expected.certified_fraction) << "seed " << seed;
    EXPECT_EQ(told.open_within, expected.open_within);
    EXPECT_EQ(told.joinable_vertices, expected.joinable_vertices);
    EXPECT_NE(told.open_within, Outlook().certificate(*merger).value().open_within);
  }
}

TEST(Outlook, WhatIsWithheldAtTheEndIsNotOpenAnyMore) {
  const auto merger = make_merger(make_toy_merge(test::large_toy_world(2, "spectral")));
  run(*merger, {});
  ASSERT_FALSE(merger->state().edges.empty());
  Outlook outlook([](const Merger& m) { return std::vector<EdgeStanding>(m.state().edges.size(), {false, 0.3}); });
  EXPECT_EQ(outlook.certificate(*merger).value().certified_fraction, 1);
  EXPECT_EQ(outlook.estimate(*merger).value().fraction, 1);
}

}  // namespace
}  // namespace mapweld
