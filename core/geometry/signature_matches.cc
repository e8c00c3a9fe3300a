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

// Features in the order of their angles (then of their numbers).
class ByAngle {
 public:
  explicit ByAngle(const AppearanceVector& image) {
    keys_.reserve(image.appearances.size());
    for (std::uint32_t i = 0; i < image.appearances.size(); ++i) {
      keys_.push_back(std::uint32_t{on_grid(image.appearances[i].angle_deg)} << 16 | i);
    }
    std::ranges::sort(keys_);
    for (const std::uint32_t key : keys_) ++starts_[(key >> 24) + 1];
    for (std::size_t k = 1; k < starts_.size(); ++k) starts_[k] += starts_[k - 1];
    signatures_.reserve(keys_.size());
    for (const std::uint32_t key : keys_) signatures_.push_back(image.appearances[key & 0xFFFF].signature);
  }

  const std::vector<Signature>& signatures() const { return signatures_; }
  std::uint16_t feature(std::uint32_t place) const { return static_cast<std::uint16_t>(keys_[place]); }

  // Those from one angle to another.
  Compared between(std::uint16_t from, std::uint16_t to) const {
    const auto size = static_cast<std::uint32_t>(keys_.size());
    const std::uint32_t first = place_of(std::uint32_t{from} << 16);
    const std::uint32_t end = place_of(std::uint32_t{to} << 16 | 0xFFFF);
    return {first == size ? 0 : first, from <= to ? end - first : size - first + end};
  }

 private:
  // Of the first key that is not less.
  std::uint32_t place_of(std::uint32_t key) const {
    std::uint32_t place = starts_[key >> 24];
    while (place < keys_.size() && keys_[place] < key) ++place;
    return place;
  }

  std::vector<std::uint32_t> keys_;  // angle above, number below
  std::vector<Signature> signatures_;
  std::array<std::uint32_t, 257> starts_{};  // by the upper byte of the angle
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

std::vector<FeatureMatch> with_near_signatures(const AppearanceVector& a, const AppearanceVector& b,
                                               const std::vector<FeatureMatch>& matches,
                                               const SignatureMatchOptions& options) {
  std::vector<FeatureMatch> near;
  near.reserve(matches.size());
  std::ranges::copy_if(matches, std::back_inserter(near), [&](const FeatureMatch& m) {
    return hamming_distance(a.appearances[m.a].signature, b.appearances[m.b].signature) <= options.max_word_distance;
  });
  return near;
}

}  // namespace mapweld
