#include "core/guard/links.h"

#include <algorithm>
#include <cstddef>
#include <tuple>

namespace mapweld {

LinkLists fullest_links(std::uint32_t vertices, const std::vector<LinkCandidate>& candidates, std::size_t most) {
  std::vector<std::vector<std::uint32_t>> at(vertices);  // candidates by end
  for (std::uint32_t c = 0; c < candidates.size(); ++c) {
    at[candidates[c].u].push_back(c);
    at[candidates[c].v].push_back(c);
  }
  LinkLists links(vertices);
  for (std::uint32_t v = 0; v < vertices; ++v) {
    const auto other = [&](std::uint32_t c) { return candidates[c].u == v ? candidates[c].v : candidates[c].u; };
    if (at[v].size() > most) {
      std::ranges::partial_sort(at[v], at[v].begin() + static_cast<std::ptrdiff_t>(most), {},
                                [&](std::uint32_t c) { return std::tuple(-candidates[c].fullness, other(c)); });
      at[v].resize(most);
    }
    for (const std::uint32_t c : at[v]) {
      links[v].push_back({other(c), candidates[c].belief});
      links[other(c)].push_back({v, candidates[c].belief});
    }
  }
  for (auto& list : links) {
    std::ranges::sort(list);
    list.erase(std::ranges::unique(list).begin(), list.end());
  }
  return links;
}

}  // namespace mapweld
