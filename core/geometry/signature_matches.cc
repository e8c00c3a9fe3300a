#include "core/geometry/signature_matches.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <iterator>

#include "core/geometry/nearest_signatures.h"
#include "core/vocabulary/appearance_vector.h"

namespace mapweld {
namespace {

// Angles as they are stored, 65536 to a turn: sums wrap around by themselves.
std::uint16_t on_grid(float angle_deg) {
  const float steps = angle_deg * kAnglesPerDegree;
  return static_cast<std::uint16_t>(static_cast<std::int32_t>(steps + (steps < 0 ? -0.5f : 0.5f)));
}

// Features in buckets by the upper byte of their angles (1.4 degrees), in the order of their numbers within one.
class ByAngle {
 public:
  explicit ByAngle(const AppearanceVector& image)
      : features_(image.appearances.size()), signatures_(image.appearances.size()) {
    std::vector<std::uint8_t> buckets;
    buckets.reserve(features_.size());
    for (const Appearance& appearance : image.appearances) {
      buckets.push_back(static_cast<std::uint8_t>(on_grid(appearance.angle_deg) >> 8));
      ++starts_[buckets.back() + std::size_t{1}];
    }
    for (std::size_t k = 1; k < starts_.size(); ++k) starts_[k] += starts_[k - 1];
    auto ends = starts_;
    for (std::size_t i = 0; i < buckets.size(); ++i) {
      const std::uint32_t place = ends[buckets[i]]++;
      features_[place] = static_cast<std::uint16_t>(i);
      signatures_[place] = image.appearances[i].signature;
    }
  }

  const std::vector<Signature>& signatures() const { return signatures_; }
  std::uint16_t feature(std::uint32_t place) const { return features_[place]; }

  // Those from one angle to another, whole buckets.
  Compared between(std::uint16_t from, std::uint16_t to) const {
    const auto size = static_cast<std::uint32_t>(features_.size());
    const std::uint32_t first = starts_[from >> 8], end = starts_[(to >> 8) + 1];
    return {first == size ? 0 : first, from <= to ? end - first : size - first + end};
  }

 private:
  std::vector<std::uint16_t> features_;
  std::vector<Signature> signatures_;
  std::array<std::uint32_t, 257> starts_{};
};

bool near_and_distinct(const NearestSignature& nearest, const SignatureMatchOptions& options) {
  return nearest.distance <= static_cast<std::uint32_t>(options.max_distance) &&
         10 * nearest.distance <= static_cast<std::uint32_t>(options.max_tenths_of_runner_up) * nearest.runner_up;
}

}  // namespace

bool has_signatures(const AppearanceVector& image) {
  return !image.appearances.empty() && image.appearances.front().signature != Signature{};
}

std::vector<FeatureMatch> signature_matches(const AppearanceVector& a, const AppearanceVector& b, float turn_deg,
                                            const SignatureMatchOptions& options) {
  const ByAngle columns(b);
  const std::uint16_t turn = on_grid(turn_deg);
  const std::uint16_t most = on_grid(options.max_turn_deg);
  std::vector<Signature> rows;
  std::vector<Compared> compared;
  rows.reserve(a.appearances.size());
  compared.reserve(a.appearances.size());
  for (const Appearance& appearance : a.appearances) {
    const int angle = on_grid(appearance.angle_deg) + turn;
    rows.push_back(appearance.signature);
    compared.push_back(
        columns.between(static_cast<std::uint16_t>(angle - most), static_cast<std::uint16_t>(angle + most)));
  }
  const NearestSignatures nearest = nearest_signatures(rows, columns.signatures(), compared);
  std::vector<FeatureMatch> matches;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const NearestSignature& there = nearest.of_a[i];
    if (!near_and_distinct(there, options)) continue;
    const NearestSignature& back = nearest.of_b[there.index];
    if (back.index != i || !near_and_distinct(back, options)) continue;
    matches.push_back({static_cast<std::uint16_t>(i), columns.feature(there.index)});
  }
  return matches;
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
