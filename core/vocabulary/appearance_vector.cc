#include "core/vocabulary/appearance_vector.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "core/vocabulary/signature.h"

namespace mapweld {
namespace {

constexpr float kLargest = 65535.0f;

float snap(float value, float steps) { return std::round(std::clamp(value * steps, 0.0f, kLargest)) / steps; }

}  // namespace

Appearance snap_to_grid(WordId word, const Keypoint& keypoint) {
  const auto turn = static_cast<std::uint16_t>(std::lround(keypoint.angle_deg * kAnglesPerDegree) & 0xFFFF);
  return {word, snap(keypoint.x_px, kPositionsPerPixel), snap(keypoint.y_px, kPositionsPerPixel),
          snap(keypoint.scale_px, kScalesPerPixel), static_cast<float>(turn) / kAnglesPerDegree};
}

AppearanceVector make_appearance_vector(const Features& features, std::span<const WordId> words) {
  if (words.size() != features.keypoints.size()) {
    throw std::invalid_argument("make_appearance_vector: as many words as keypoints are needed");
  }
  const std::span<const std::uint8_t> descriptors = features.descriptors;
  const bool has_descriptors = descriptors.size() == words.size() * kDescriptorDimension;
  AppearanceVector image{features.width_px, features.height_px, {}};
  image.appearances.reserve(words.size());
  for (std::size_t i = 0; i < words.size(); ++i) {
    image.appearances.push_back(snap_to_grid(words[i], features.keypoints[i]));
    if (has_descriptors) {
      image.appearances.back().signature =
          signature_of(descriptors.subspan(i * kDescriptorDimension).first<kDescriptorDimension>());
    }
  }
  std::sort(image.appearances.begin(), image.appearances.end());
  return image;
}

}  // namespace mapweld
