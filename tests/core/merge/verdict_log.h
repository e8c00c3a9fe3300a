// What a merger did, in order, in the oracle's words.
#pragma once

#include <algorithm>
#include <set>
#include <tuple>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "core/merge/run.h"
#include "tests/core/merge/paper_oracle.h"

namespace mapweld::test {

// Steps the merger to its end and notes every verdict when it is reached; votes of rejected pairs are 0 here.
inline std::vector<OracleVerdict> log_verdicts(Merger& merger) {
  std::vector<OracleVerdict> verdicts;
  const std::vector<MergeMember>& members = merger.input().members;
  const auto member_of = [&members](VertexId v) {
    const auto holds = [v](const MergeMember& m) { return std::ranges::binary_search(m.vertices, v); };
    return static_cast<std::size_t>(std::ranges::find_if(members, holds) - members.begin());
  };
  const auto is_source = [&](VertexId u, VertexId v) {
    const auto [i, j] = std::minmax({member_of(u), member_of(v)});
    return order_members(members, i, j).m2 == member_of(u);
  };
  std::size_t edges = merger.state().edges.size(), rejected = merger.state().rejected.size();
  run(merger, {}, [&](const Merger& m) {
    const MergeState& state = m.state();
    if (state.edges.size() > edges) {
      const MergeEdge& e = state.edges.back();
      const bool u_is_source = is_source(e.u, e.v);
      verdicts.push_back({u_is_source ? e.u : e.v, u_is_source ? e.v : e.u, e.votes, true});
    }
    if (state.rejected.size() > rejected) {
      verdicts.push_back({state.rejected.back().source, state.rejected.back().target, 0, false});
    }
    edges = state.edges.size();
    rejected = state.rejected.size();
  });
  return verdicts;
}

inline std::vector<OracleVerdict> without_votes_of_rejected(std::vector<OracleVerdict> verdicts) {
  for (OracleVerdict& v : verdicts) v.votes = v.accepted ? v.votes : 0;
  return verdicts;
}

// The edges as a set: (u, v, votes, inliers), ascending.
inline std::vector<std::tuple<VertexId, VertexId, std::uint32_t, int>> edge_set(const MergeState& state) {
  std::vector<std::tuple<VertexId, VertexId, std::uint32_t, int>> edges;
  for (const MergeEdge& e : state.edges) edges.emplace_back(e.u, e.v, e.votes, e.verification.inliers);
  std::sort(edges.begin(), edges.end());
  return edges;
}

using PairSet = std::set<std::pair<VertexId, VertexId>>;

// The edges of a merge, whatever their order.
inline PairSet edges_of(const MergeState& state) {
  PairSet edges;
  for (const MergeEdge& e : state.edges) edges.emplace(e.u, e.v);
  EXPECT_EQ(edges.size(), state.edges.size()) << "an edge twice";
  return edges;
}

}  // namespace mapweld::test
