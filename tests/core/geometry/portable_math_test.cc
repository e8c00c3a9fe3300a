#include "core/geometry/portable_math.h"

#include <cmath>
#include <map>
#include <random>
#include <set>

#include <gtest/gtest.h>

namespace mapweld {
namespace {

TEST(PortableMath, LogarithmsAgreeWithTheLibrary) {
  std::mt19937_64 random(1);
  for (int i = 0; i < 20000; ++i) {
    const double exponent = static_cast<double>(random() % 2000) - 1000;
    const double x = std::ldexp(1 + static_cast<double>(random() >> 11) * 0x1p-53, static_cast<int>(exponent));
    EXPECT_NEAR(portable_log(x), std::log(x), 1e-13 * std::max(1.0, std::fabs(std::log(x))));
    EXPECT_NEAR(portable_log10(x), std::log10(x), 1e-13 * std::max(1.0, std::fabs(std::log10(x))));
    EXPECT_NEAR(portable_log2(x), std::log2(x), 1e-13 * std::max(1.0, std::fabs(std::log2(x))));
  }
  EXPECT_EQ(portable_log(1), 0);
  EXPECT_NEAR(portable_log(5e-324), std::log(5e-324), 1e-10);
}

TEST(PortableMath, BinomialsAgreeWithPascalsTriangle) {
  double row[61] = {1};
  for (int n = 0; n <= 60; ++n) {
    for (int k = 0; k <= n; ++k) EXPECT_NEAR(log10_binomial(n, k), std::log10(row[k]), 1e-11);
    for (int k = n + 1; k > 0 && n < 60; --k) row[k] += row[k - 1];
  }
  EXPECT_NEAR(log10_binomial(65535, 12345),
              (std::lgamma(65536) - std::lgamma(12346) - std::lgamma(53191)) / std::log(10), 1e-6);
}

TEST(PortableMath, RotationsAgreeWithTheLibrary) {
  for (int i = 0; i <= 65536; ++i) {
    const double deg = i * 360.0 / 65536;
    const Rotation r = portable_rotation(deg);
    EXPECT_NEAR(r.cos, std::cos(deg * M_PI / 180), 1e-14);
    EXPECT_NEAR(r.sin, std::sin(deg * M_PI / 180), 1e-14);
  }
}

TEST(PortableMath, EveryPartOfAnImageCountsInItsHash) {
  const AppearanceVector image{
      .width_px = 320, .height_px = 240, .appearances = {{WordId{1}, 2, 3, 4, 5}, {WordId{6}, 7, 8, 9, 10}}};
  std::set<std::uint64_t> hashes{content_hash(image)};
  const auto changed = [&](auto change) {
    AppearanceVector other = image;
    change(other);
    hashes.insert(content_hash(other));
  };
  changed([](auto& v) { v.width_px = 321; });
  changed([](auto& v) { v.height_px = 241; });
  changed([](auto& v) { v.appearances[0].word = WordId{2}; });
  changed([](auto& v) { v.appearances[0].x_px = 2.125f; });
  changed([](auto& v) { v.appearances[1].y_px = 8.125f; });
  changed([](auto& v) { v.appearances[1].scale_px = 9.5f; });
  changed([](auto& v) { v.appearances[1].angle_deg = 11; });
  changed([](auto& v) { v.appearances.pop_back(); });
  changed([](auto& v) { std::swap(v.appearances[0].x_px, v.appearances[0].y_px); });
  EXPECT_EQ(hashes.size(), 10u);
}

// Verification draws by it, and verdicts are stored.
TEST(PortableMath, TheHashOfAnImageIsPinned) {
  const AppearanceVector image{
      .width_px = 640, .height_px = 480, .appearances = {{WordId{1}, 2, 3, 4, 5}, {WordId{7}, 8.5f, 9, 10, 359}}};
  EXPECT_EQ(content_hash(image), 0x9861213f7113aaa5ULL);
}

}  // namespace
}  // namespace mapweld
