// How an edge is read from its columns: what edge_store.cc and edge_lists.cc share.
#pragma once

#include <string>
#include <string_view>

#include "schema/maps/edge_store.h"

namespace mapweld::rows {

inline constexpr std::string_view kEdgeColumns =
    "SELECT id, u, v, votes, inliers, log10_false_alarms, confirmed, job, verifications, elapsed_s, doubt, confidence "
    "FROM edges ";

// "SELECT columns FROM edges" and what is to follow.
inline std::string select_edges(std::string_view rest) { return std::string(kEdgeColumns).append(rest); }

inline EdgeRow edge(const sqlite::Statement& row) {
  EdgeRow edge;
  edge.id = row.id<EdgeId>(0);
  edge.u = row.id<VertexId>(1);
  edge.v = row.id<VertexId>(2);
  edge.votes = static_cast<std::uint32_t>(row.integer(3));
  edge.inliers = static_cast<std::uint32_t>(row.integer(4));
  edge.log10_false_alarms = row.real(5);
  edge.confirmed = row.integer(6) != 0;
  edge.inter = !row.is_null(7);
  if (edge.inter) edge.job = row.id<JobId>(7);
  edge.verifications = static_cast<std::uint64_t>(row.integer(8));
  edge.elapsed_s = row.real(9);
  if (!edge.confirmed) edge.doubt = row.text(10);
  edge.confidence = row.optional_real(11);
  return edge;
}

}  // namespace mapweld::rows
