#include "core/geometry/signature_matches.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <iterator>

#include "core/vocabulary/appearance_vector.h"

namespace mapweld {
namespace {

// Angles as they are stored, 65536 to a turn: sums wrap around by themselves.
std::uint16_t on_grid(float angle_deg) {
  const float steps = angle_deg * kAnglesPerDegree;
  return static_cast<std::uint16_t>(static_cast<std::int32_t>(steps + (steps < 0 ? -0.5f : 0.5f)));
}

bool near_and_distinct(const NearestSignature& nearest, const SignatureMatchOptions& options) {
  return nearest.distance <= static_cast<std::uint32_t>(options.max_distance) &&
         10 * nearest.distance <= static_cast<std::uint32_t>(options.max_tenths_of_runner_up) * nearest.runner_up;
}

// A runner-up that is further away, and a nearest one, are as good as none.
std::uint8_t furthest_that_counts(const SignatureMatchOptions& options) {
  const int of_runner_up = (10 * options.max_distance - 1) / options.max_tenths_of_runner_up;
  return static_cast<std::uint8_t>(std::min(std::max(options.max_distance, of_runner_up), 127));
}

}  // namespace

SignaturesByAngle::SignaturesByAngle(const AppearanceVector& image)
    : signatures_(image.appearances.size()),
      angles_(image.appearances.size()),
      features_(image.appearances.size()),
      blocks_({}) {
  for (std::size_t i = 0; i < angles_.size(); ++i) {
    signatures_[i] = image.appearances[i].signature;
    angles_[i] = on_grid(image.appearances[i].angle_deg);
    ++starts_[(angles_[i] >> 8) + std::size_t{1}];
  }
  for (std::size_t k = 1; k < starts_.size(); ++k) starts_[k] += starts_[k - 1];
  std::array<std::uint32_t, 257> next = starts_;
  std::vector<Signature> by_place(signatures_.size());
  for (std::size_t i = 0; i < angles_.size(); ++i) {
    const std::uint32_t place = next[angles_[i] >> 8]++;
    features_[place] = static_cast<std::uint16_t>(i);
    by_place[place] = signatures_[i];
  }
  blocks_ = SignatureBlocks(by_place);
}

Compared SignaturesByAngle::between(std::uint16_t from, std::uint16_t to) const {
  const auto size = static_cast<std::uint32_t>(features_.size());
  const std::uint32_t first = starts_[from >> 8], end = starts_[(to >> 8) + 1];
  return {first == size ? 0 : first, from <= to ? end - first : size - first + end};
}

bool has_signatures(const AppearanceVector& image) {
  return !image.appearances.empty() && image.appearances.front().signature != Signature{};
}

std::vector<FeatureMatch> signature_matches(const SignaturesByAngle& a, const SignaturesByAngle& b, float turn_deg,
                                            const SignatureMatchOptions& options) {
  const std::uint16_t turn = on_grid(turn_deg);
  const std::uint16_t most = on_grid(options.max_turn_deg);
  std::vector<Compared> compared;
  compared.reserve(a.angles().size());
  for (const std::uint16_t own : a.angles()) {
    const int angle = own + turn;
    compared.push_back(b.between(static_cast<std::uint16_t>(angle - most), static_cast<std::uint16_t>(angle + most)));
  }
  const NearestSignatures nearest =
      nearest_signatures(a.signatures(), b.blocks(), compared, furthest_that_counts(options));
  std::vector<FeatureMatch> matches;
  for (std::size_t i = 0; i < nearest.of_a.size(); ++i) {
    const NearestSignature& there = nearest.of_a[i];
    if (!near_and_distinct(there, options)) continue;
    const NearestSignature& back = nearest.of_b[there.index];
    if (back.index != i || !near_and_distinct(back, options)) continue;
    matches.push_back({static_cast<std::uint16_t>(i), b.feature(there.index)});
  }
  return matches;
}

std::vector<FeatureMatch> signature_matches(const AppearanceVector& a, const AppearanceVector& b, float turn_deg,
                                            const SignatureMatchOptions& options) {
  return signature_matches(SignaturesByAngle(a), SignaturesByAngle(b), turn_deg, options);
}

CommonTurn common_turn(const AppearanceVector& a, const AppearanceVector& b, const std::vector<FeatureMatch>& matches) {
  constexpr std::size_t kBins = 32;
  std::array<std::size_t, kBins> bins{};
  for (const FeatureMatch& m : matches) {
    const auto turn =
        static_cast<std::uint16_t>(on_grid(b.appearances[m.b].angle_deg) - on_grid(a.appearances[m.a].angle_deg));
    ++bins[turn / (65536 / kBins)];
  }
  CommonTurn common;
  for (std::size_t i = 0; i < kBins; ++i) {
    const std::size_t agreeing = bins[i] + bins[(i + 1) % kBins];
    if (agreeing <= common.agreeing) continue;
    common = {360.0f / kBins * static_cast<float>(i + 1), agreeing};
  }
  return common;
}

std::vector<FeatureMatch> with_near_signatures(const AppearanceVector& a, const AppearanceVector& b,
                                               const std::vector<FeatureMatch>& matches,
                                               const SignatureMatchOptions& options) {
  std::vector<FeatureMatch> near;
  near.reserve(matches.size());
  std::ranges::copy_if(matches, std::back_inserter(near), [&](const FeatureMatch& m) {
    return hamming_distance(a.appearances[m.a].signature, b.appearances[m.b].signature) <= options.max_distance;
  });
  return near;
}

}  // namespace mapweld
