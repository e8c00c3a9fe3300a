#include "core/guard/own_rarity.h"

#include <algorithm>
#include <bit>
#include <memory>
#include <random>
#include <set>
#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>

namespace mapweld {
namespace {

std::vector<std::shared_ptr<const AppearanceVector>> random_images(std::uint64_t seed, std::uint32_t n) {
  std::mt19937_64 random(seed);
  std::vector<std::shared_ptr<const AppearanceVector>> images;
  for (std::uint32_t v = 0; v < n; ++v) {
    AppearanceVector image{.width_px = 320, .height_px = 240, .appearances = {}};
    for (int f = 0; f < 30; ++f) {
      // Distances lie around the limit.
      image.appearances.push_back(
          {WordId{static_cast<std::uint32_t>(random() % 300)},
           static_cast<float>(f),
           0,
           4,
           0,
           {{static_cast<std::uint32_t>(random()), static_cast<std::uint32_t>(random()), 0, 1}}});
    }
    std::ranges::sort(image.appearances);
    images.push_back(std::make_shared<const AppearanceVector>(std::move(image)));
  }
  return images;
}

int distance(const Signature& a, const Signature& b) {
  int bits = 0;
  for (std::size_t k = 0; k < 4; ++k) bits += std::popcount(a.bits[k] ^ b.bits[k]);
  return bits;
}

TEST(OwnRarity, IsWhatTheDefinitionSays) {
  int rare = 0, common = 0;
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const std::uint32_t n = 25;
    const auto images = random_images(seed, n);
    std::mt19937_64 random(seed);
    std::vector<std::set<std::uint32_t>> linked(n);
    for (int k = 0; k < 20; ++k) {
      const auto u = static_cast<std::uint32_t>(random() % n), v = static_cast<std::uint32_t>(random() % n);
      if (u == v) continue;
      linked[u].insert(v);
      linked[v].insert(u);
    }
    std::vector<std::vector<std::uint32_t>> neighbours;
    for (const auto& set : linked) neighbours.emplace_back(set.begin(), set.end());
    OwnRarity rarity([&](std::uint32_t v) { return images[v]; }, neighbours);
    for (std::uint32_t u = 0; u < n; ++u) {
      std::set<std::uint32_t> far;
      for (std::uint32_t w = 0; w < n; ++w) {
        const bool shares = std::ranges::any_of(linked[u], [&](std::uint32_t x) { return linked[x].contains(w); });
        if (w != u && !linked[u].contains(w) && !shares) far.insert(w);
      }
      EXPECT_EQ(rarity.far_images(u), far.size());
      int held = 0;
      for (std::size_t i = 0; i < images[u]->appearances.size(); ++i) {
        const Appearance& a = images[u]->appearances[i];
        bool elsewhere = false;
        for (const std::uint32_t w : far) {
          for (const Appearance& b : images[w]->appearances) {
            elsewhere = elsewhere || (a.word == b.word && distance(a.signature, b.signature) <= 32);
          }
        }
        ASSERT_EQ(rarity.rare(u)[i], !elsewhere);
        ++(elsewhere ? common : rare);
        held += elsewhere ? 1 : 0;
      }
      EXPECT_DOUBLE_EQ(rarity.common_share(u), held / static_cast<double>(images[u]->appearances.size()));
    }
  }
  EXPECT_GT(rare, 100);
  EXPECT_GT(common, 100);
}

TEST(OwnRarity, MatchesOfOtherImagesAreRefused) {
  const auto images = random_images(1, 2);
  OwnRarity rarity([&](std::uint32_t v) { return images[v]; }, {{}, {}});
  EXPECT_THROW(rarity.rare_matches(0, rarity, 1, {VertexId{0}, VertexId{1}, {{3, 30}}}), std::invalid_argument);
}

}  // namespace
}  // namespace mapweld
