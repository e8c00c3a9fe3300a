#include "core/merge/cluster_fullness.h"

#include <algorithm>
#include <array>
#include <cstddef>

namespace mapweld {
namespace {

std::array<std::uint64_t, 2> ends(const WeighedEdge& edge, std::span<const std::uint32_t> member_of) {
  const std::uint32_t u = to_index(edge.u), v = to_index(edge.v);
  return {std::uint64_t{u} << 32 | member_of[v], std::uint64_t{v} << 32 | member_of[u]};
}

}  // namespace

std::vector<bool> clusters_that_show_their_place(std::span<const WeighedEdge> edges, std::span<const double> fullness,
                                                 std::span<const std::uint32_t> cluster_of, std::uint32_t clusters,
                                                 const PlaceOptions& options) {
  std::vector<double> peak(clusters, 0);
  std::unordered_map<std::uint64_t, double> best;  // by cluster and vertex
  for (std::size_t e = 0; e < edges.size(); ++e) {
    peak[cluster_of[e]] = std::max(peak[cluster_of[e]], fullness[e]);
    for (const VertexId v : {edges[e].u, edges[e].v}) {
      double& of_vertex = best[std::uint64_t{cluster_of[e]} << 32 | to_index(v)];
      of_vertex = std::max(of_vertex, fullness[e]);
    }
  }
  std::vector<std::uint32_t> vertices(clusters, 0), full(clusters, 0);
  for (const auto& [key, of_vertex] : best) {
    ++vertices[key >> 32];
    full[key >> 32] += of_vertex >= options.min_vertex_fullness ? 1 : 0;
  }
  std::vector<bool> shows(clusters);
  for (std::uint32_t c = 0; c < clusters; ++c) {
    shows[c] = peak[c] >= options.min_peak_fullness &&
               (peak[c] >= options.sure_peak_fullness || full[c] >= options.min_full_vertices * vertices[c]);
  }
  return shows;
}

void FullestEdges::add(const WeighedEdge& edge, double fullness) {
  for (const std::uint64_t end : ends(edge, member_of_)) {
    double& best = best_[end];
    best = std::max(best, fullness);
  }
}

bool FullestEdges::is_of_one_end(const WeighedEdge& edge, double fullness) const {
  return std::ranges::any_of(ends(edge, member_of_), [&](std::uint64_t end) { return best_.at(end) == fullness; });
}

}  // namespace mapweld
