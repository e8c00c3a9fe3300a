#include "core/geometry/static_matches.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "core/geometry/epipolar_verifier.h"
#include "tests/core/geometry/signed_scene.h"

namespace mapweld {
namespace {

using test::Bits;

Appearance feature(std::uint32_t word, float x_px, float y_px, Signature signature) {
  return {WordId{word}, std::round(x_px * 8) / 8, std::round(y_px * 8) / 8, 4, 45, signature};
}

// Features in words that no scene has.
constexpr std::uint32_t kFirstWord = 5'000'000;

// What one camera has in all its images: `count` features in a strip at the lower edge, moved by up to half a pixel and
// changed by some bits from image to image. `scale`: of an image so many times larger.
void add_strip(AppearanceVector& image, int count, std::uint64_t of_image, float scale = 1) {
  Bits same(4711);
  Bits own(1000 + of_image);
  for (int k = 0; k < count; ++k) {
    const float x =
        10 + 295.0f * static_cast<float>(k) / static_cast<float>(count) + 0.5f * static_cast<float>(own.below(2));
    const float y = 215 + static_cast<float>(k * 7 % 19) + 0.5f * static_cast<float>(own.below(2));
    const Signature signature = own.near(same.signature(), 6);
    image.appearances.push_back(feature(kFirstWord + static_cast<std::uint32_t>(k), scale * x, scale * y, signature));
    image.appearances.back().scale_px *= scale;
  }
  std::ranges::sort(image.appearances);
}

bool in_strip(const AppearanceVector& image, std::uint16_t index) {
  return to_index(image.appearances.at(index).word) >= kFirstWord;
}

AppearanceVector view(std::uint64_t seed, int features) {
  return test::signed_scene({.seed = seed,
                             .points = 0,
                             .outliers = 0,
                             .clutter = features,
                             .first_word = static_cast<std::uint32_t>(seed * 10'000)},
                            0, 0)
      .a;
}

TEST(StaticMatches, OfTwoViewsWithoutAnythingInCommonNothingIsLeftOut) {
  EXPECT_FALSE(without_static(view(1, 200), view(2, 200), {}));
  EXPECT_FALSE(without_static(AppearanceVector{}, view(2, 200), {}));
}

TEST(StaticMatches, WhatTheCameraCarriesIsLeftOutAndNothingElse) {
  AppearanceVector a = view(1, 200);
  AppearanceVector b = view(2, 150);
  add_strip(a, 40, 1);
  add_strip(b, 40, 2);
  StaticMatchOptions options;
  options.surroundings = 0;
  const auto rest = without_static(a, b, options);
  ASSERT_TRUE(rest);
  EXPECT_EQ(rest->a.appearances.size(), 200u);
  EXPECT_EQ(rest->b.appearances.size(), 150u);
  for (std::size_t k = 0; k < rest->index_a.size(); ++k) {
    EXPECT_FALSE(in_strip(a, rest->index_a[k]));
    EXPECT_EQ(rest->a.appearances[k], a.appearances[rest->index_a[k]]);
  }
  EXPECT_TRUE(std::ranges::is_sorted(rest->index_b));
}

TEST(StaticMatches, AsMuchInAnImageOfTwiceTheSize) {
  AppearanceVector a = view(1, 200);
  AppearanceVector b = view(2, 150);
  b.width_px *= 2;
  b.height_px *= 2;
  add_strip(a, 40, 1);
  add_strip(b, 40, 2, 2);
  const auto rest = without_static(a, b, {});
  ASSERT_TRUE(rest);
  EXPECT_EQ(std::ranges::count_if(rest->index_a, [&](std::uint16_t i) { return in_strip(a, i); }), 0);
  EXPECT_EQ(std::ranges::count_if(rest->index_b, [&](std::uint16_t i) { return in_strip(b, i); }), 0);
}

TEST(StaticMatches, FeaturesAroundStaticOnesGoWithThem) {
  AppearanceVector a = view(1, 200);
  AppearanceVector b = view(2, 200);
  add_strip(a, 40, 1);
  add_strip(b, 40, 2);
  Bits random(9);
  const Appearance at = *std::ranges::find_if(
      a.appearances, [](const Appearance& appearance) { return to_index(appearance.word) >= kFirstWord; });
  a.appearances.push_back(feature(kFirstWord - 1, at.x_px + 3, at.y_px, random.signature()));
  a.appearances.push_back(feature(kFirstWord - 2, at.x_px, at.y_px - 40, random.signature()));
  std::ranges::sort(a.appearances);
  const auto rest = without_static(a, b, {});
  ASSERT_TRUE(rest);
  const auto has = [&](std::uint32_t word) {
    return std::ranges::count(rest->a.appearances, WordId{word}, &Appearance::word);
  };
  EXPECT_EQ(has(kFirstWord - 1), 0);
  EXPECT_EQ(has(kFirstWord - 2), 1);
}

TEST(StaticMatches, AViewThatHasNotMovedStaysWhole) {
  const AppearanceVector a = view(1, 200);
  AppearanceVector b = a;
  Bits random(3);
  for (std::size_t k = 0; k < b.appearances.size(); ++k) {
    Signature& signature = b.appearances[k].signature;
    signature = k % 4 == 0 ? random.signature() : random.near(signature, 8);  // noise
  }
  EXPECT_FALSE(without_static(a, b, {}));
}

TEST(StaticMatches, HalfAViewThatHasNotMovedIsNotTheSameView) {
  const AppearanceVector a = view(1, 200);
  AppearanceVector b = a;
  Bits random(3);
  for (Appearance& appearance : b.appearances) {
    if (appearance.y_px > 100) appearance.signature = random.signature();
  }
  EXPECT_TRUE(without_static(a, b, {}));
}

TEST(StaticMatches, WithoutSignaturesWordsTell) {
  AppearanceVector a = view(1, 200);
  AppearanceVector b = view(2, 150);
  add_strip(a, 40, 1);
  add_strip(b, 40, 2);
  const auto rest = without_static(test::unsigned_image(a), test::unsigned_image(b), {});
  ASSERT_TRUE(rest);
  EXPECT_LE(rest->a.appearances.size(), 200u);
}

// ---- Verdicts -----------------------------------------------------------------------------------------------------

TEST(StaticMatches, TwoViewsOfDifferentPlacesWithOneStripAreNoPair) {
  const EpipolarVerifier verifier;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    AppearanceVector a = view(seed, 200);
    AppearanceVector b = view(100 + seed, 200);
    add_strip(a, 60, seed);
    add_strip(b, 60, 100 + seed);
    EXPECT_FALSE(verifier.verify(a, b).accepted) << seed;
  }
}

TEST(StaticMatches, TheGeometryOfARealPairIsThatWithoutTheStrip) {
  const EpipolarVerifier verifier;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    auto scene = test::signed_scene({.seed = seed, .points = 60, .outliers = 10, .clutter = 100}, 60, 12);
    const Verification plain = verifier.verify(scene.a, scene.b);
    ASSERT_TRUE(plain.accepted) << seed;
    add_strip(scene.a, 80, seed);
    add_strip(scene.b, 80, 100 + seed);
    const Verification v = verifier.verify(scene.a, scene.b);
    ASSERT_TRUE(v.accepted) << seed;
    EXPECT_GE(v.inliers, plain.inliers * 7 / 10) << seed;
    for (const auto& [i, j] : v.inlier_matches) {
      EXPECT_FALSE(in_strip(scene.a, i) || in_strip(scene.b, j)) << seed;
    }
    const Verification other = verifier.verify(scene.b, scene.a);
    EXPECT_EQ(other.inliers, v.inliers);
    EXPECT_EQ(other.inlier_matches, mirrored(v).inlier_matches);
  }
}

TEST(StaticMatches, ARobotThatStandsStillHasItsEdge) {
  const EpipolarVerifier verifier;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    AppearanceVector a = view(seed, 130);
    AppearanceVector b = a;
    Bits random(seed);
    for (std::size_t k = 0; k < b.appearances.size(); ++k) {
      Signature& signature = b.appearances[k].signature;
      signature = k % 4 == 0 ? random.signature() : random.near(signature, 8);
    }
    add_strip(a, 40, seed);
    add_strip(b, 40, 100 + seed);
    EXPECT_TRUE(verifier.verify(a, b).accepted) << seed;
  }
}

TEST(StaticMatches, WhatIsKnownToBeStaticTellsTheRestAndIsNeverLeft) {
  AppearanceVector a = view(1, 200);
  AppearanceVector b = view(2, 200);
  add_strip(a, 40, 1);
  add_strip(b, 40, 2);
  // All but three of the strip are known in a: alone, three are too few to be left out.
  AppearanceVector known = a;
  int left = 3;
  std::erase_if(known.appearances, [&](const Appearance& p) {
    if (to_index(p.word) < kFirstWord || left-- > 0) return false;
    known.static_appearances.push_back(p);
    return true;
  });
  ASSERT_EQ(known.static_appearances.size(), 37u);
  for (const bool swapped : {false, true}) {
    const auto plain = swapped ? without_static(b, a, {}) : without_static(a, b, {});
    const auto rest = swapped ? without_static(b, known, {}) : without_static(known, b, {});
    ASSERT_TRUE(plain && rest);
    EXPECT_EQ(rest->a, plain->a);
    EXPECT_EQ(rest->b, plain->b);
    const auto& kept = swapped ? rest->b : rest->a;
    const auto& index = swapped ? rest->index_b : rest->index_a;
    ASSERT_EQ(index.size(), kept.appearances.size());
    for (std::size_t i = 0; i < index.size(); ++i) EXPECT_EQ(known.appearances.at(index[i]), kept.appearances[i]);
  }
  EXPECT_EQ(at_same_place(b, known, {}), at_same_place(b, a, {}));
}

}  // namespace
}  // namespace mapweld
