#include "core/merge/merge_metrics.h"

#include <gtest/gtest.h>

#include "core/merge/run.h"
#include "tests/core/merge/toy_maps.h"

namespace mapweld {
namespace {

MergeEdge edge(std::uint32_t u, std::uint32_t v) {
  MergeEdge e;
  e.u = VertexId{u};
  e.v = VertexId{v};
  return e;
}

TEST(MergeMetrics, CountsWhatIsJoined) {
  const std::vector<MergeMember> members = number_members({4, 3});
  AppearanceGraph graph(7);
  for (const auto& [u, v] : {std::pair{0u, 1u}, {1u, 2u}, {4u, 5u}}) graph.add_edge(VertexId{u}, VertexId{v}, 20);
  const MergeMetrics before = merge_metrics(graph, members, {});
  EXPECT_EQ(before.components, 4u);
  EXPECT_EQ(before.algebraic_connectivity, 0.0);
  EXPECT_EQ(before.largest_vertices, 3u);
  EXPECT_NEAR(before.largest_algebraic_connectivity, 1.0, 1e-12);  // a path of three
  EXPECT_EQ(before.joined, (std::vector<std::uint32_t>{0, 0}));
  EXPECT_EQ(before.independent_joins, 0u);

  // Two edges share vertex 2: one image's removal would cut both.
  const std::vector<MergeEdge> inter{edge(2, 4), edge(2, 5), edge(3, 6)};
  for (const MergeEdge& e : inter) graph.add_edge(e.u, e.v, 15);
  const MergeMetrics after = merge_metrics(graph, members, inter);
  EXPECT_EQ(after.components, 2u);
  EXPECT_EQ(after.joined, (std::vector<std::uint32_t>{2, 3}));
  EXPECT_EQ(after.independent_joins, 2u);
  EXPECT_EQ(after.largest_vertices, 5u);
  EXPECT_GT(after.largest_algebraic_connectivity, 0.0);
}

TEST(MergeMetrics, OnlyGrowWhereTheyShould) {
  const auto merger = make_merger(make_toy_merge(test::toy_world(19)));
  MergeMetrics before = merge_metrics(merger->graph(), merger->input().members, merger->state().edges);
  run(*merger, {}, [&before](const Merger& m) {
    const MergeMetrics now = merge_metrics(m.graph(), m.input().members, m.state().edges);
    EXPECT_LE(now.components, before.components);
    EXPECT_GE(now.algebraic_connectivity, before.algebraic_connectivity * (1 - 1e-12));
    EXPECT_GE(now.independent_joins, before.independent_joins);
    for (std::size_t k = 0; k < now.joined.size(); ++k) EXPECT_GE(now.joined[k], before.joined[k]);
    before = now;
  });
  EXPECT_GT(before.independent_joins, 10u);
}

}  // namespace
}  // namespace mapweld
