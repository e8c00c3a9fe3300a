// Which vertices hang together while edges arrive (union by size, path halving; Tarjan 1975).
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

namespace mapweld {

class DisjointSets {
 public:
  explicit DisjointSets(std::uint32_t elements = 0) : parent_(elements), sizes_(elements, 1) {
    for (std::uint32_t i = 0; i < elements; ++i) parent_[i] = i;
  }
  // The element that stands for the set of `element`. Not thread-safe, although const: paths get shorter.
  std::uint32_t root(std::uint32_t element) const {
    while (parent_[element] != element) element = parent_[element] = parent_[parent_[element]];
    return element;
  }
  // False when they are in one set already. The larger set's root remains; of two equal ones the lower root.
  bool join(std::uint32_t a, std::uint32_t b) {
    a = root(a);
    b = root(b);
    if (a == b) return false;
    if (sizes_[a] < sizes_[b] || (sizes_[a] == sizes_[b] && b < a)) std::swap(a, b);
    parent_[b] = a;
    sizes_[a] += sizes_[b];
    return true;
  }
  std::uint32_t size_of(std::uint32_t element) const { return sizes_[root(element)]; }

 private:
  mutable std::vector<std::uint32_t> parent_;
  std::vector<std::uint32_t> sizes_;
};

}  // namespace mapweld
