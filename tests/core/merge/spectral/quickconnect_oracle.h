// QuickConnect's order over all candidates, by definition.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <tuple>
#include <vector>

#include "core/graph/appearance_graph.h"
#include "core/types.h"

namespace mapweld::test {

// QuickConnect's order as it is when an epoch begins, counted from nothing: (not the best of its unjoined source,
// joined, lower degree, votes descending, number).
using QuickConnectKey = std::tuple<bool, bool, std::uint32_t, std::int64_t, std::size_t>;
inline std::vector<QuickConnectKey> quickconnect_order(const std::vector<Candidate>& all,
                                                       const std::vector<bool>& has_verdict,
                                                       const std::vector<bool>& is_joined,
                                                       const AppearanceGraph& graph) {
  std::vector<QuickConnectKey> keys;
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (has_verdict[i]) continue;
    const bool joined = is_joined[to_index(all[i].source)];
    bool is_best = true;
    for (std::size_t k = 0; k < all.size(); ++k) {
      if (has_verdict[k] || all[k].source != all[i].source) continue;
      if (all[k].votes > all[i].votes || (all[k].votes == all[i].votes && k < i)) is_best = false;
    }
    const std::uint32_t degree = joined ? std::min(graph.degree(all[i].source), graph.degree(all[i].target)) : 0;
    keys.emplace_back(joined, !joined && !is_best, degree, -std::int64_t{all[i].votes}, i);
  }
  std::ranges::sort(keys);
  return keys;
}

}  // namespace mapweld::test
