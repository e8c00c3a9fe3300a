// Made scenes whose features have signatures, and perhaps not the words that belong together.
#pragma once

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <set>
#include <utility>
#include <vector>

#include "core/random.h"
#include "core/types.h"
#include "tests/core/geometry/two_view_scene.h"

namespace mapweld::test {

// Repeatable signatures.
class Bits {
 public:
  explicit Bits(std::uint64_t seed) : random_(seed) {}

  Signature signature() {
    Signature s;
    for (auto& part : s.bits) part = static_cast<std::uint32_t>(random_.next());
    return s;
  }
  // Differs from `s` in exactly so many bits.
  Signature near(Signature s, int bits) {
    std::vector<std::uint32_t> order(128);
    std::iota(order.begin(), order.end(), 0u);
    for (int k = 0; k < bits; ++k) {
      std::swap(order[static_cast<std::size_t>(k)],
                order[static_cast<std::size_t>(k) + random_.below(128u - static_cast<std::uint32_t>(k))]);
      const std::uint32_t bit = order[static_cast<std::size_t>(k)];
      s.bits[bit / 32] ^= 1u << bit % 32;
    }
    return s;
  }

  std::uint32_t below(std::uint32_t bound) { return static_cast<std::uint32_t>(random_.below(bound)); }

 private:
  SplitMix64 random_;
};

inline AppearanceVector unsigned_image(AppearanceVector image) {
  for (Appearance& appearance : image.appearances) appearance.signature = {};
  return image;
}

struct SignedScene {
  AppearanceVector a;
  AppearanceVector b;
  std::set<std::pair<std::uint16_t, std::uint16_t>> true_matches;
};

// A scene whose matching features have signatures that differ in `bits` bits, all others unrelated ones. All but
// `common_words` of the matches lose their common word.
inline SignedScene signed_scene(const SceneOptions& options, int common_words, int bits) {
  const TwoViewScene scene = make_scene(options);
  SignedScene made{scene.a, scene.b, {}};
  Bits random(options.seed + 77);
  for (auto* image : {&made.a, &made.b}) {
    for (Appearance& appearance : image->appearances) appearance.signature = random.signature();
  }
  std::vector<Signature> of_match;
  int kept = 0;
  for (const auto& [i, j] : scene.true_matches) {
    made.b.appearances[j].signature = random.near(made.a.appearances[i].signature, bits);
    of_match.push_back(made.b.appearances[j].signature);
    if (++kept > common_words) made.b.appearances[j].word = WordId{1'000'000u + static_cast<std::uint32_t>(kept)};
  }
  std::ranges::sort(made.b.appearances);
  std::size_t k = 0;
  for (const auto& [i, j] : scene.true_matches) {
    const auto found = std::ranges::find(made.b.appearances, of_match[k++], &Appearance::signature);
    made.true_matches.emplace(i, static_cast<std::uint16_t>(found - made.b.appearances.begin()));
  }
  return made;
}

}  // namespace mapweld::test
