#include "tests/support/rendering/camera_effects.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "tests/support/rendering/repeatable.h"

namespace mapweld::rendered {
namespace {

constexpr int kTableBits = 10;
constexpr int kTableSize = 1 << kTableBits;

// x^p for x in (0, 1], through series of our own: libm's pow may differ in its last bit between machines.
double power(double x, double p) {
  if (x <= 0) return 0;
  int exponent = 0;
  const double mantissa = std::frexp(x, &exponent);  // [0.5, 1)
  const double t = (mantissa - 1) / (mantissa + 1);
  double log = 0;
  double term = t;
  for (int n = 1; n < 40; n += 2) {
    log += 2 * term / n;
    term *= t * t;
  }
  double y = p * (log + exponent * 0.69314718055994530942);
  const int halvings = 8;
  y /= 1 << halvings;
  double value = 1;
  for (int n = 12; n >= 1; --n) value = 1 + value * y / n;
  for (int i = 0; i < halvings; ++i) value *= value;
  return value;
}

// Table from light (0 .. 255 in quarters) to sixteenths of grey levels.
std::array<int, kTableSize> tone_table(double gain, double gamma) {
  std::array<int, kTableSize> table{};
  for (int i = 0; i < kTableSize; ++i) {
    const double light = std::min(1.0, gain * i / (kTableSize - 1.0));
    table[static_cast<std::size_t>(i)] = static_cast<int>(power(light, gamma) * 255 * 16 + 0.5);
  }
  return table;
}

// The mean light of each pixel, 0 .. kTableSize - 1 in each of blue, green, red.
std::vector<int> mean_light(const std::vector<std::uint32_t>& samples, int width_px, int height_px, int oversampling,
                            double motion_blur_px) {
  const int sample_width = width_px * oversampling;
  // Samples on either side that motion smears into a pixel.
  const int extra = static_cast<int>(std::clamp(motion_blur_px, 0.0, 8.0) * oversampling / 2 + 0.5);
  const int taps = oversampling + 2 * extra;
  const std::uint32_t full = 255U * static_cast<std::uint32_t>(taps * oversampling);
  std::vector<int> light(static_cast<std::size_t>(width_px * height_px) * 3);
  int* out = light.data();
  for (int y = 0; y < height_px; ++y) {
    for (int x = 0; x < width_px; ++x) {
      std::uint32_t red_and_blue = 0;
      std::uint32_t green = 0;
      const int first = x * oversampling - extra;
      for (int row = 0; row < oversampling; ++row) {
        const std::uint32_t* line =
            samples.data() + static_cast<std::size_t>(y * oversampling + row) * static_cast<std::size_t>(sample_width);
        for (int tap = 0; tap < taps; ++tap) {
          const std::uint32_t sample = line[std::clamp(first + tap, 0, sample_width - 1)];
          red_and_blue += sample & 0x00ff00ffU;
          green += (sample >> 8) & 255U;
        }
      }
      for (const std::uint32_t sum : {red_and_blue & 0xffffU, green, red_and_blue >> 16}) {
        *out++ = static_cast<int>(sum * (kTableSize - 1) / full);
      }
    }
  }
  return light;
}

}  // namespace

cv::Mat expose(const std::vector<std::uint32_t>& samples, int width_px, int height_px, int oversampling,
               const CameraConditions& conditions) {
  const double warmth = std::clamp(conditions.warmth, -1.0, 1.0);
  const std::array<std::array<int, kTableSize>, 3> tones{
      tone_table(conditions.gain * (1 - 0.16 * warmth), conditions.gamma),
      tone_table(conditions.gain, conditions.gamma),
      tone_table(conditions.gain * (1 + 0.12 * warmth), conditions.gamma)};
  const std::vector<int> light = mean_light(samples, width_px, height_px, oversampling, conditions.motion_blur_px);
  const double half_diagonal2 = 0.25 * (width_px * width_px + height_px * height_px);
  const int vignetting = static_cast<int>(std::clamp(conditions.vignetting, 0.0, 1.0) * 256);

  // The sum of four bytes has deviation 147.8; noise is in sixteenths of grey levels.
  const int noise_scale = static_cast<int>(std::clamp(conditions.noise_sigma, 0.0, 64.0) * 16 * 65536 / 147.8);

  cv::Mat image(height_px, width_px, CV_8UC3);
  for (int y = 0; y < height_px; ++y) {
    std::uint8_t* out = image.ptr(y);
    const int* line = light.data() + static_cast<std::ptrdiff_t>(y) * width_px * 3;
    const double dy = y - (height_px - 1) / 2.0;
    for (int x = 0; x < width_px; ++x) {
      const double dx = x - (width_px - 1) / 2.0;
      const int radius2 = static_cast<int>((dx * dx + dy * dy) / half_diagonal2 * 256);
      const int kept = 65536 - vignetting * radius2;

      const std::uint64_t bits =
          mix(conditions.noise_seed * 0x2545f4914f6cdd1dULL +
              static_cast<std::uint64_t>(y) * static_cast<std::uint64_t>(width_px) + static_cast<std::uint64_t>(x));
      int common = -510;
      for (int shift = 0; shift < 32; shift += 8) common += static_cast<int>((bits >> shift) & 255U);
      for (int c = 0; c < 3; ++c) {
        const int i = 3 * x + c;
        const int index = (line[i] * (kept >> 4)) >> 12;
        const int own = static_cast<int>((bits >> (32 + 8 * c)) & 255U) - 128;
        const int noise = ((common + own / 2) * noise_scale) >> 16;
        const int value = tones[static_cast<std::size_t>(c)][static_cast<std::size_t>(index)] + noise;
        out[i] = static_cast<std::uint8_t>(std::clamp((value + 8) >> 4, 0, 255));
      }
    }
  }
  return image;
}

}  // namespace mapweld::rendered
