// Who stands beside whom: the lists of links along which edges support each other.
#pragma once

#include <cstdint>
#include <vector>

namespace mapweld {

// A link from a vertex to another, and what it lets through at most: log odds (infinity for a link that is not judged),
// or a fullness.
struct Link {
  std::uint32_t to = 0;
  double belief = 0;
  friend auto operator<=>(const Link&, const Link&) = default;
};

// By vertex, its links, ascending.
using LinkLists = std::vector<std::vector<Link>>;

// An edge that may be a link, and how fully it shows one view.
struct LinkCandidate {
  std::uint32_t u = 0;
  std::uint32_t v = 0;
  double fullness = 0;
  double belief = 0;
};

// The fullest `most` candidates of each vertex become links of both their ends (ties: the lower neighbour). So few
// neighbours are the nearest ones, and a look-alike is seldom among them: what is passed on along them stays near.
LinkLists fullest_links(std::uint32_t vertices, const std::vector<LinkCandidate>& candidates, std::size_t most);

}  // namespace mapweld
