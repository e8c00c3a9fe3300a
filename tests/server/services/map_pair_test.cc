// Two images of one map, explained: against what mapping has stored of them.
#include <set>
#include <utility>

#include <gtest/gtest.h>

#include "core/guard/guard_evidence.h"
#include "schema/maps/edge_store.h"
#include "schema/maps/map_store.h"
#include "tests/server/services/pairs_of_walls.h"
#include "tests/support/temp_store.h"

namespace mapweld::test {
namespace {

using server::explain_pair;

// Of two images of one map, asked by a merge, the numbers of the merged map apart.
contract::Pair renumbered(contract::Pair pair, std::int64_t by) {
  pair.u += by;
  pair.v += by;
  return pair;
}

TEST_F(PairsOfWalls, WithinOneMapAreAsItsMappingMadeThem) {
  const std::int64_t id = merge({"a", "b"}, "ab");
  const std::string stored = dump_store(services_.store());
  std::set<std::pair<std::uint32_t, std::uint32_t>> with_edge;
  for (const contract::Edge& edge : services_.maps().edges("b", {}, {}).items) {
    const auto u = static_cast<std::uint32_t>(edge.u), v = static_cast<std::uint32_t>(edge.v);
    with_edge.emplace(u, v);
    const contract::Pair pair = explain_pair(services_.store(), "b", v, u, true);
    EXPECT_EQ(pair.u, edge.u);
    EXPECT_EQ(pair.v, edge.v);
    EXPECT_EQ(pair.map, "b");
    EXPECT_EQ(pair.merge, std::nullopt);
    EXPECT_EQ(pair.votes, edge.votes);
    EXPECT_EQ(pair.inliers, edge.inliers);
    EXPECT_EQ(pair.verdict, "accepted");
    EXPECT_EQ(pair.confirmed, true);
    EXPECT_EQ(pair.confidence, std::nullopt);
    expect_one_wall(pair, static_cast<int>(u), static_cast<int>(v));
    EXPECT_EQ(explain(id, u + kSteps, v + kSteps), renumbered(pair, kSteps));
  }
  EXPECT_FALSE(with_edge.empty());
  int without = 0;
  for (std::uint32_t u = 0; u < kSteps; ++u) {
    for (std::uint32_t v = u + 1; v < kSteps; ++v) {
      if (with_edge.contains({u, v})) continue;
      ++without;
      const contract::Pair pair = explain_pair(services_.store(), "b", u, v, false);
      EXPECT_TRUE(pair.verdict == "rejected" || pair.verdict == "not_candidate") << pair.verdict;
      EXPECT_EQ(pair.reason == "no_candidate", pair.verdict == "not_candidate");
      EXPECT_EQ(pair.inliers.has_value(), pair.verdict == "rejected");
    }
  }
  EXPECT_GT(without, 0);
  EXPECT_EQ(dump_store(services_.store()), stored);
}

TEST_F(PairsOfWalls, WithinOneMapSayWhyAnEdgeIsNotConfirmed) {
  const std::int64_t id = merge({"a", "b"}, "ab");
  {
    WriteTransaction db = services_.store().write();
    const MapId map = find_map(db, "b")->id;
    ASSERT_TRUE(find_own_edge(db, map, VertexId{0}, VertexId{1}));
    set_judgements(
        db, map,
        std::vector<JudgedEdge>{{VertexId{0}, VertexId{1}, {0.25, Reason::kUnsupported, {{"rare_matches", 3, -1.5}}}},
                                {VertexId{1}, VertexId{2}, {0.95, Reason::kNone, {{"rare_matches", 9, 2.5}}}}});
    db.commit();
  }
  const contract::Pair withheld = explain_pair(services_.store(), "b", 0, 1, false);
  EXPECT_EQ(withheld.verdict, "accepted");
  EXPECT_EQ(withheld.confirmed, false);
  EXPECT_EQ(withheld.reason, "unsupported");
  EXPECT_EQ(withheld.confidence, 0.25);
  EXPECT_EQ(withheld.min_confidence, kDefaultMinConfidence);
  ASSERT_EQ(withheld.evidence.value().size(), 1u);
  EXPECT_EQ(withheld.evidence->front().weight, -1.5);
  EXPECT_EQ(withheld.evidence->front().says, evidence_says("rare_matches"));
  EXPECT_EQ(explain(id, kSteps, kSteps + 1, false), renumbered(withheld, kSteps));
  const contract::Pair confirmed = explain_pair(services_.store(), "b", 2, 1, false);
  EXPECT_EQ(confirmed.confirmed, true);
  EXPECT_EQ(confirmed.reason, std::nullopt);
  EXPECT_EQ(confirmed.confidence, 0.95);
}

TEST_F(PairsOfWalls, WithinOneMapThatNobodyVerifiedArePending) {
  contract::CreateMap narrow;
  narrow.name = "narrow";
  narrow.parameters.emplace();
  narrow.parameters->verify_top = 1;
  services_.maps().create(narrow);
  // The third stands between the others: one of them has more votes.
  for (const int step : {0, 2, 1}) services_.upload("narrow", std::to_string(step), photo_jpeg(1, step));
  contract::Pair verified = explain_pair(services_.store(), "narrow", 0, 2, false);
  contract::Pair other = explain_pair(services_.store(), "narrow", 1, 2, false);
  if (verified.votes < other.votes) std::swap(verified, other);
  EXPECT_EQ(verified.verdict, "accepted");
  EXPECT_EQ(other.verdict, "pending");
  EXPECT_EQ(other.reason, std::nullopt);
  EXPECT_EQ(other.confirmed, std::nullopt);
  EXPECT_GE(other.inliers, 10);
}

TEST_F(PairsOfWalls, OfAMapAreRefusedAsThoseOfAMerge) {
  const auto code = [&](const char* map, std::uint32_t u, std::uint32_t v) {
    return code_of([&] { explain_pair(services_.store(), map, u, v, false); });
  };
  EXPECT_EQ(code("nowhere", 0, 1), "no_such_map");
  EXPECT_EQ(code("a", 0, kSteps), "no_such_vertex");
  EXPECT_EQ(code("a", 2, 2), "invalid_parameter");
  const std::int64_t id = merge({"a", "b"}, "ab");
  EXPECT_EQ(explain_pair(services_.store(), "ab", 2, 4, true), explain(id, 2, 4));
}

}  // namespace
}  // namespace mapweld::test
