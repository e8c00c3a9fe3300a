#include "core/guard/guarded_map.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>

#include "core/geometry/portable_math.h"
#include "core/guard/beliefs.h"
#include "core/guard/edge_fullness.h"

namespace mapweld {
namespace {

bool is_successive(const VerifiedEdge& e) {
  return to_index(e.u) + 1 == to_index(e.v) || to_index(e.v) + 1 == to_index(e.u);
}

std::vector<std::vector<std::uint32_t>> verified_neighbours(std::uint32_t vertices,
                                                            std::span<const VerifiedEdge> edges) {
  std::vector<std::vector<std::uint32_t>> neighbours(vertices);
  for (const VerifiedEdge& e : edges) {
    const std::uint32_t u = to_index(e.u), v = to_index(e.v);
    if (u >= vertices || v >= vertices || u == v) throw std::invalid_argument("an edge beyond its map's vertices");
    neighbours[u].push_back(v);
    neighbours[v].push_back(u);
  }
  for (auto& list : neighbours) std::ranges::sort(list);
  return neighbours;
}

// The log odds that an edge between successive images is one because they are neighbours on the way: how much more
// often they verify than any other two, between 0 (a collection without order) and `most`. Two ways that are none are
// counted with the others, so that a handful says little.
double way_odds(std::uint32_t vertices, std::span<const VerifiedEdge> edges, double most) {
  if (vertices < 3) return 0;
  const auto successive = static_cast<double>(std::ranges::count_if(edges, is_successive));
  const double ways = vertices - 1.0, pairs = vertices / 2.0 * ways;
  const double rate = successive / (ways + 2);
  const double others = (static_cast<double>(edges.size()) - successive + 1) / (pairs - ways + 1);
  return rate > others ? std::clamp(portable_log((rate - others) / others), 0.0, most) : 0;
}

}  // namespace

GuardedMap::GuardedMap(std::uint32_t vertices, const ImageLookup& images, std::span<const VerifiedEdge> edges,
                       const GuardOptions& options, const Executor* executor)
    : fullness_(vertices, 0), rarity_(images, verified_neighbours(vertices, edges)) {
  rarity_.learn_linked(executor);
  std::vector<EdgeSigns> signs(edges.size());
  for (std::size_t e = 0; e < edges.size(); ++e) {
    const std::uint32_t u = to_index(edges[e].u), v = to_index(edges[e].v);
    signs[e].fullness = edge_fullness(*images(u), *images(v), edges[e]);
    for (const std::uint32_t end : {u, v}) fullness_[end] = std::max(fullness_[end], signs[e].fullness);
  }
  const auto links_of = [&](const auto& is_one, const auto& belief) {
    std::vector<LinkCandidate> candidates;
    for (std::uint32_t e = 0; e < edges.size(); ++e) {
      if (is_one(e)) candidates.push_back({to_index(edges[e].u), to_index(edges[e].v), signs[e].fullness, belief(e)});
    }
    return fullest_links(vertices, candidates, options.most_links);
  };
  const auto is_strong = [&](std::uint32_t e) { return is_near_view(signs[e], options.model); };
  constexpr double kCertain = std::numeric_limits<double>::infinity();
  for (std::size_t e = 0; e < edges.size(); ++e) {
    const std::uint32_t u = to_index(edges[e].u), v = to_index(edges[e].v);
    signs[e].rare_matches = rarity_.rare_matches(u, rarity_, v, edges[e]);
    signs[e].far_images = std::min(rarity_.far_images(u), rarity_.far_images(v));
    signs[e].common_share = std::max(rarity_.common_share(u), rarity_.common_share(v));
    signs[e].inner_fullness = std::sqrt(fullness_[u] * fullness_[v]);
  }
  around_ = links_of([](std::uint32_t) { return true; }, [&](std::uint32_t e) { return signs[e].fullness; });
  LinkLists confirmed(vertices);
  Beliefs beliefs(around_, confirmed, options.model, true);
  for (std::size_t e = 0; e < edges.size(); ++e) beliefs.add(to_index(edges[e].u), to_index(edges[e].v), signs[e]);
  beliefs.settle();

  // What is confirmed is a link for others, until nothing is added.
  const double needed = log_odds_of(options.min_confidence);
  const auto belief = [&](std::uint32_t e) { return beliefs.belief(e); };
  const auto is_confirmed = [&](std::uint32_t e) { return belief(e) >= needed; };
  for (std::uint32_t before = 0;;) {
    std::uint32_t count = 0;
    for (std::uint32_t e = 0; e < edges.size(); ++e) count += is_confirmed(e) ? 1 : 0;
    if (count == before) break;
    before = count;
    confirmed = links_of(is_confirmed, belief);
    beliefs.settle(true);
  }
  passing_ = links_of([&](std::uint32_t e) { return is_strong(e) || is_confirmed(e); },
                      [&](std::uint32_t e) { return is_strong(e) ? kCertain : belief(e); });
  const double odds = way_odds(vertices, edges, options.model.most_on_the_way);
  for (std::uint32_t e = 0; e < edges.size(); ++e) {
    EdgeSigns seen = beliefs.signs(e);
    if (is_successive(edges[e])) seen.on_the_way = odds;
    verdicts_.push_back(verdict_of(seen, beliefs.belief(e), options, true));
  }
}

}  // namespace mapweld
