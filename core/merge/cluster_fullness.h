// How fully the edges of a cluster show their place, and which edge shows it best at each image.
#pragma once

#include <cstdint>
#include <span>
#include <unordered_map>
#include <vector>

#include "core/merge/edge_relations.h"
#include "core/types.h"

namespace mapweld {

struct PlaceOptions {
  double min_peak_fullness = 3.2;   // AliasGuardOptions
  double sure_peak_fullness = 4.6;  // AliasGuardOptions
  double min_vertex_fullness = 2;   // AliasGuardOptions
  double min_full_vertices = 0.4;   // AliasGuardOptions
};

// For each cluster: whether it shows its place. `fullness` and `cluster_of` by edge.
std::vector<bool> clusters_that_show_their_place(std::span<const WeighedEdge> edges, std::span<const double> fullness,
                                                 std::span<const std::uint32_t> cluster_of, std::uint32_t clusters,
                                                 const PlaceOptions& options);

// The fullest edge that each vertex has to each other member.
class FullestEdges {
 public:
  // `member_of`: by merged vertex; must outlive this object.
  explicit FullestEdges(std::span<const std::uint32_t> member_of) : member_of_(member_of) {}

  void add(const WeighedEdge& edge, double fullness);
  // Whether no edge of one of its ends, to the member of the other, is fuller. The edge itself was added.
  bool is_of_one_end(const WeighedEdge& edge, double fullness) const;

 private:
  std::span<const std::uint32_t> member_of_;
  std::unordered_map<std::uint64_t, double> best_;  // by vertex and member
};

}  // namespace mapweld
