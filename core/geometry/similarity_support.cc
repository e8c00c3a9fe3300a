#include "core/geometry/similarity_support.h"

#include <cstddef>

#include "core/wide_loops.h"

namespace mapweld {

namespace {

MAPWELD_INLINE inline void count_support(const Correspondences& c, const SimilaritySupportOptions& options,
                                         std::vector<std::uint16_t>& support) {
  const std::size_t n = c.size();
  const float relative2 = options.relative_slack * options.relative_slack;
  const float slack2 = options.slack * options.slack;
  for (std::size_t i = 0; i < n; ++i) {
    const float re = c.m_re[i];
    const float im = c.m_im[i];
    const float ratio = c.ratio[i];
    int agreeing = 0;
    for (std::size_t j = 0; j < n; ++j) {
      const float dxa = c.xa[j] - c.xa[i];
      const float dya = c.ya[j] - c.ya[i];
      const float dxb = c.xb[j] - c.xb[i];
      const float dyb = c.yb[j] - c.yb[i];
      const float ex = re * dxa - im * dya - dxb;
      const float ey = im * dxa + re * dya - dyb;
      const bool placed = ex * ex + ey * ey <= slack2 + relative2 * (dxb * dxb + dyb * dyb);
      const bool turned = re * c.m_re[j] + im * c.m_im[j] >= options.max_turn_cos * ratio * c.ratio[j];
      const bool scaled = c.ratio[j] <= options.max_ratio * ratio && ratio <= options.max_ratio * c.ratio[j];
      agreeing += placed & turned & scaled;
    }
    support[i] = static_cast<std::uint16_t>(agreeing - 1);
  }
}

}  // namespace

std::vector<std::uint16_t> similarity_support(const Correspondences& c, const SimilaritySupportOptions& options) {
  std::vector<std::uint16_t> support(c.size(), 0);
  wide_loops([&]() MAPWELD_INLINE { count_support(c, options, support); });
  return support;
}

}  // namespace mapweld
