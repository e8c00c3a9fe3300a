// A match between two images, from whatever source.
#pragma once

#include <compare>
#include <cstdint>

namespace mapweld {

// Feature `a` of the first and `b` of the second image: indices into their appearances.
struct FeatureMatch {
  std::uint16_t a = 0;
  std::uint16_t b = 0;
  friend auto operator<=>(const FeatureMatch&, const FeatureMatch&) = default;
};

}  // namespace mapweld
