#include "core/merge/rare_matches.h"

#include <algorithm>
#include <numeric>

namespace mapweld {
namespace {

// Marks the matches whose word occurs elsewhere in the map of the edges' u (or v).
void mark_common(bool at_u, std::span<const MergeEdge* const> edges, const AppearanceSource& appearances,
                 const WordPlaces& places, std::span<const std::uint32_t> member_of, HopBalls& balls,
                 std::vector<std::vector<bool>>& is_common) {
  const auto end = [&](std::uint32_t e) { return at_u ? edges[e]->u : edges[e]->v; };
  std::vector<std::uint32_t> order(edges.size());
  std::iota(order.begin(), order.end(), 0u);
  std::ranges::sort(order, {}, end);
  std::vector<char> is_near(balls.vertices(), 0);
  for (std::size_t first = 0; first < order.size();) {
    const VertexId centre = end(order[first]);
    const std::uint32_t member = member_of[to_index(centre)];
    const auto ball = balls.around(centre);
    const auto image = appearances.appearances(centre);
    for (const ReachedVertex& r : ball) is_near[r.vertex] = 1;
    for (; first < order.size() && end(order[first]) == centre; ++first) {
      const std::uint32_t e = order[first];
      const auto& matches = edges[e]->verification.inlier_matches;
      for (std::size_t m = 0; m < matches.size(); ++m) {
        if (is_common[e][m]) continue;
        const WordId word = image->appearances.at(at_u ? matches[m].first : matches[m].second).word;
        is_common[e][m] = std::ranges::any_of(places.vertices_with(word), [&](std::uint32_t vertex) {
          return is_near[vertex] == 0 && member_of[vertex] == member;
        });
      }
    }
    for (const ReachedVertex& r : ball) is_near[r.vertex] = 0;
  }
}

}  // namespace

std::vector<int> rare_matches(std::span<const MergeEdge* const> edges, const AppearanceSource& appearances,
                              const WordPlaces& places, std::span<const std::uint32_t> member_of, HopBalls& balls) {
  std::vector<std::vector<bool>> is_common;
  for (const MergeEdge* edge : edges) is_common.emplace_back(edge->verification.inlier_matches.size(), false);
  mark_common(true, edges, appearances, places, member_of, balls, is_common);
  mark_common(false, edges, appearances, places, member_of, balls, is_common);
  std::vector<int> rare;
  for (const auto& common : is_common) rare.push_back(static_cast<int>(std::ranges::count(common, false)));
  return rare;
}

}  // namespace mapweld
