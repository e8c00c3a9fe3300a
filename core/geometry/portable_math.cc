#include "core/geometry/portable_math.h"

#include <bit>
#include <vector>

#include "core/random.h"

namespace mapweld {
namespace {

constexpr double kLn2 = 0.693147180559945309417232121458;
constexpr double kLn10 = 2.302585092994045684017991454684;
constexpr double kPi = 3.141592653589793238462643383280;

// log10 of the factorials of 0 .. 65535.
const std::vector<double>& log10_factorials() {
  static const std::vector<double> table = [] {
    std::vector<double> t(65536, 0.0);
    for (std::size_t i = 2; i < t.size(); ++i) t[i] = t[i - 1] + portable_log10(static_cast<double>(i));
    return t;
  }();
  return table;
}

}  // namespace

double portable_log(double x) {
  // x = m 2^e with m in [sqrt(1/2), sqrt(2)); log m = 2 artanh((m - 1) / (m + 1)).
  std::uint64_t bits = std::bit_cast<std::uint64_t>(x);
  int exponent = static_cast<int>(bits >> 52) - 1023;
  if (exponent == -1023) {  // subnormal
    bits = std::bit_cast<std::uint64_t>(x * 0x1p54);
    exponent = static_cast<int>(bits >> 52) - 1023 - 54;
  }
  double m = std::bit_cast<double>((bits & 0x000fffffffffffffULL) | 0x3ff0000000000000ULL);
  if (m > 1.4142135623730951) {
    m *= 0.5;
    ++exponent;
  }
  const double t = (m - 1) / (m + 1);
  const double t2 = t * t;
  double series = 0;
  for (int k = 21; k >= 1; k -= 2) series = series * t2 + 1.0 / k;
  return exponent * kLn2 + 2 * t * series;
}

double portable_log2(double x) { return portable_log(x) / kLn2; }

double portable_log10(double x) { return portable_log(x) / kLn10; }

double log10_binomial(int n, int k) {
  const std::vector<double>& f = log10_factorials();
  return f[n] - f[k] - f[n - k];
}

Rotation portable_rotation(double angle_deg) {
  // Reduce to a quarter turn around a multiple of 90 degrees, then Taylor series on [-45, 45].
  const int quarter = static_cast<int>(angle_deg / 90 + 0.5);
  const double t = (angle_deg - 90.0 * quarter) * (kPi / 180);
  const double t2 = t * t;
  double s = 0;
  double c = 0;
  for (int k = 17; k >= 3; k -= 2) s = (1 + s) * (-t2 / (k * (k - 1)));
  for (int k = 18; k >= 2; k -= 2) c = (1 + c) * (-t2 / (k * (k - 1)));
  s = t * (1 + s);
  c = 1 + c;
  switch (quarter & 3) {
    case 0:
      return {c, s};
    case 1:
      return {-s, c};
    case 2:
      return {-c, -s};
    default:
      return {s, -c};
  }
}

std::uint64_t content_hash(const AppearanceVector& image) {
  std::uint64_t h =
      mix_bits(static_cast<std::uint64_t>(image.width_px) << 32 | static_cast<std::uint32_t>(image.height_px));
  const auto bits = [](float f) { return std::uint64_t{std::bit_cast<std::uint32_t>(f)}; };
  for (const Appearance& a : image.appearances) {
    h = mix_bits(h + to_index(a.word) + kGoldenGamma);
    h ^= mix_bits((bits(a.x_px) << 32 | bits(a.y_px)) + h);
    h ^= mix_bits((bits(a.scale_px) << 32 | bits(a.angle_deg)) + 3 * h);
  }
  return h;
}

}  // namespace mapweld
