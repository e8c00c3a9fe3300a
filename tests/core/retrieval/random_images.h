// Images of random words: few words, so that many are shared and repeated.
#pragma once

#include <algorithm>
#include <cstdint>
#include <random>
#include <vector>

#include "core/types.h"

namespace mapweld::test {

inline AppearanceVector random_image(std::mt19937_64& random, std::uint32_t words, int max_features) {
  AppearanceVector image{.width_px = 320, .height_px = 240, .appearances = {}};
  const int features = static_cast<int>(random() % (max_features + 1));
  for (int i = 0; i < features; ++i) {
    // The product of two draws makes low words frequent, as in real images.
    const auto word = static_cast<std::uint32_t>((random() % words) * (random() % words) / words);
    image.appearances.push_back({.word = WordId{word},
                                 .x_px = static_cast<float>(random() % 320),
                                 .y_px = static_cast<float>(random() % 240),
                                 .scale_px = 4,
                                 .angle_deg = 0});
  }
  std::ranges::sort(image.appearances);
  return image;
}

inline std::vector<AppearanceVector> random_map(std::uint64_t seed, int images, std::uint32_t words, int max_features) {
  std::mt19937_64 random(seed);
  std::vector<AppearanceVector> map;
  for (int i = 0; i < images; ++i) map.push_back(random_image(random, words, max_features));
  return map;
}

}  // namespace mapweld::test
