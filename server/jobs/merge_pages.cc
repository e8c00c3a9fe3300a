#include "server/jobs/merge_pages.h"

#include <charconv>

#include "schema/maps/edge_store.h"
#include "schema/merges/merge_store.h"

namespace mapweld::server {

std::optional<std::int64_t> parse_cursor(const std::optional<std::string>& cursor) {
  if (!cursor) return std::nullopt;
  std::int64_t number = 0;
  const char* const end = cursor->data() + cursor->size();
  const auto [stop, error] = std::from_chars(cursor->data(), end, number);
  if (error != std::errc{} || stop != end || number < 0) {
    throw MergeJobError("invalid_parameter", "\"cursor\" is not one that a page gave.");
  }
  return number;
}

Page<MergeCurvePoint> curve_page(const Reader& db, JobId job, std::size_t limit, std::optional<std::int64_t> from) {
  const auto describe = [](const CurvePointRow& row) -> MergeCurvePoint {
    return {.step = row.step,
            .elapsed_s = row.elapsed_s,
            .verifications = row.verifications,
            .edges = row.edges,
            .confirmed_edges = row.confirmed,
            .components = row.components,
            .algebraic_connectivity = row.algebraic_connectivity,
            .largest_component = {row.largest_vertices, row.largest_algebraic_connectivity},
            .certified_fraction = row.certified_fraction,
            .phase = row.phase};
  };
  std::optional<std::uint64_t> after;
  if (from) after = static_cast<std::uint64_t>(*from);
  return make_page<MergeCurvePoint>(list_curve(db, job, limit + 1, after), limit, describe,
                                    [](const CurvePointRow& row) { return row.step; });
}

Page<MergeEdgePoint> edge_page(const Reader& db, JobId job, std::size_t limit, std::optional<std::int64_t> from) {
  const auto describe = [](const EdgeRow& row) -> MergeEdgePoint {
    return {.u = row.u,
            .v = row.v,
            .votes = row.votes,
            .inliers = row.inliers,
            .verifications = row.verifications,
            .elapsed_s = row.elapsed_s,
            .confirmed = row.confirmed,
            .confidence = row.confidence,
            .doubt = row.doubt};
  };
  std::optional<EdgeId> after;
  if (from) after = EdgeId{*from};
  return make_page<MergeEdgePoint>(list_merge_edges(db, job, limit + 1, after), limit, describe,
                                   [](const EdgeRow& row) { return to_index(row.id); });
}

}  // namespace mapweld::server
