// Images of random words: few words, so that many are shared and repeated.
#pragma once

#include <algorithm>
#include <cstdint>
#include <map>
#include <random>
#include <utility>
#include <vector>

#include "core/retrieval/vote_signature.h"
#include "core/types.h"

namespace mapweld::test {

// A signature near one of the word's own: of two for one word about half agree.
template <typename Random>
Signature signature_for(WordId word, Random& random) {
  Signature signature;
  for (std::uint32_t k = 0; k < 4; ++k) {
    std::uint32_t flips = 0;
    for (std::uint32_t bit = 0; bit < 32; ++bit) flips |= std::uint32_t{random() % 32 < 3} << bit;
    signature.bits[k] = (to_index(word) * 4 + k + 1) * 2654435761u ^ flips;
  }
  return signature;
}

// The rule by its definition: every feature of one image against every one of the other, all 64 bits one by one.
inline std::uint32_t votes_by_signatures(const AppearanceVector& a, const AppearanceVector& b) {
  const auto agrees = [](const Appearance& p, const Appearance& q) {
    if (p.word != q.word) return false;
    if (p.signature == Signature{} || q.signature == Signature{}) return true;
    int differing = 0;
    for (const int bit : kVoteBits) {
      differing += (p.signature.bits[bit / 32] >> bit % 32 & 1) != (q.signature.bits[bit / 32] >> bit % 32 & 1) ? 1 : 0;
    }
    return differing <= kVoteDistance;
  };
  std::map<WordId, std::pair<std::uint32_t, std::uint32_t>> of_word;
  for (const Appearance& p : a.appearances) {
    of_word[p.word].first += std::ranges::any_of(b.appearances, [&](const Appearance& q) { return agrees(p, q); });
  }
  for (const Appearance& q : b.appearances) {
    of_word[q.word].second += std::ranges::any_of(a.appearances, [&](const Appearance& p) { return agrees(p, q); });
  }
  std::uint32_t votes = 0;
  for (const auto& [word, counts] : of_word) votes += std::min(counts.first, counts.second);
  return votes;
}

// One image in six has no signatures.
inline AppearanceVector random_image(std::mt19937_64& random, std::uint32_t words, int max_features) {
  AppearanceVector image{.width_px = 320, .height_px = 240, .appearances = {}};
  const int features = static_cast<int>(random() % (max_features + 1));
  const bool is_signed = random() % 6 != 0;
  for (int i = 0; i < features; ++i) {
    // The product of two draws makes low words frequent, as in real images.
    const auto word = static_cast<std::uint32_t>((random() % words) * (random() % words) / words);
    image.appearances.push_back({.word = WordId{word},
                                 .x_px = static_cast<float>(random() % 320),
                                 .y_px = static_cast<float>(random() % 240),
                                 .scale_px = 4,
                                 .angle_deg = 0,
                                 .signature = is_signed ? signature_for(WordId{word}, random) : Signature{}});
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
