#include "core/geometry/signature_matches.h"

#include <algorithm>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/geometry/epipolar_verifier.h"
#include "core/geometry/nearest_signatures.h"
#include "core/geometry/view_overlap.h"
#include "tests/core/geometry/signed_scene.h"

namespace mapweld {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

// ---- Nearest neighbours, by every kernel --------------------------------------------------------------------------

class NearestSignatureKernels : public testing::TestWithParam<PopcountSimd> {};

bool are_compared(const std::vector<Compared>& compared, std::size_t i, std::size_t j, std::size_t columns) {
  return (j + columns - compared[i].first) % columns < compared[i].count;
}

// `of_a`: for each of a in b, else the other way round.
std::vector<NearestSignature> by_sorting(const std::vector<Signature>& a, const std::vector<Signature>& b,
                                         const std::vector<Compared>& compared, std::uint32_t within, bool of_a) {
  const auto& of = of_a ? a : b;
  const auto& in = of_a ? b : a;
  std::vector<NearestSignature> nearest;
  for (std::uint32_t i = 0; i < of.size(); ++i) {
    const Signature& s = of[i];
    std::vector<std::pair<std::uint32_t, std::uint32_t>> others;  // distance, index
    for (std::uint32_t j = 0; j < in.size(); ++j) {
      if (!(of_a ? are_compared(compared, i, j, b.size()) : are_compared(compared, j, i, b.size()))) continue;
      std::uint32_t differing = 0;
      for (std::size_t i = 0; i < 128; ++i) {
        differing += (s.bits[i / 32] >> i % 32 & 1) != (in[j].bits[i / 32] >> i % 32 & 1) ? 1 : 0;
      }
      if (differing <= within) others.emplace_back(differing, j);
    }
    std::ranges::sort(others);
    nearest.emplace_back();
    if (others.empty()) continue;
    nearest.back() = {others[0].second, others[0].first, others.size() > 1 ? others[1].first : kNoDistance};
  }
  return nearest;
}

TEST_P(NearestSignatureKernels, FindWhatSortingFinds) {
  test::Bits bits(11);
  for (const std::size_t rows : {1u, 2u, 33u}) {
    for (const std::size_t columns : {1u, 7u, 31u, 32u, 33u, 64u, 100u, 170u}) {
      std::vector<Signature> a, b;
      for (std::size_t i = 0; i < rows; ++i) a.push_back(bits.signature());
      for (std::size_t j = 0; j < columns; ++j) {
        b.push_back(j % 3 == 0 ? bits.near(a[j % rows], static_cast<int>(j % 9)) : bits.signature());
      }
      if (columns > 4) b[4] = b[1];  // a tie
      b.front() = Signature{{0, 0, 0, 0}};
      a.front() = Signature{{~0u, ~0u, ~0u, ~0u}};
      for (const bool all : {true, false}) {
        std::vector<Compared> compared;
        for (std::size_t i = 0; i < rows; ++i) {
          const auto n = static_cast<std::uint32_t>(columns);
          compared.push_back(all ? Compared{0, n} : Compared{bits.below(n), bits.below(n + 1)});
        }
        for (const std::uint8_t within : {0, 7, 60, 127}) {
          const NearestSignatures nearest = nearest_signatures(a, SignatureBlocks(b), compared, within, GetParam());
          EXPECT_EQ(nearest.of_a, by_sorting(a, b, compared, within, true)) << rows << ' ' << columns << ' ' << +within;
          EXPECT_EQ(nearest.of_b, by_sorting(a, b, compared, within, false))
              << rows << ' ' << columns << ' ' << +within;
        }
      }
    }
  }
}

// On a processor without AVX2 the limit gives the lesser kernel, which is then tested twice.
INSTANTIATE_TEST_SUITE_P(, NearestSignatureKernels, testing::Values(PopcountSimd::kScalar, PopcountSimd::kAvx2));

TEST(NearestSignatures, OfNothingAreNothing) {
  const std::vector<Signature> one(1);
  EXPECT_EQ(nearest_signatures({}, SignatureBlocks(one), {}, 31).of_b, std::vector<NearestSignature>(1));
  EXPECT_EQ(nearest_signatures(one, SignatureBlocks({}), std::vector<Compared>(1), 31).of_a,
            std::vector<NearestSignature>(1));
}

// ---- Matches ------------------------------------------------------------------------------------------------------

AppearanceVector image_of(const std::vector<Signature>& signatures) {
  AppearanceVector image{320, 240, {}};
  for (std::uint32_t i = 0; i < signatures.size(); ++i) {
    image.appearances.push_back({WordId{i}, 10.0f * static_cast<float>(i), 20, 4, 0, signatures[i]});
  }
  return image;
}

TEST(SignatureMatches, AreEachOthersNearestNearAndDistinct) {
  test::Bits bits(5);
  const Signature p = bits.signature(), q = bits.signature(), r = bits.signature(), s = bits.signature();
  // p: found. q: two candidates equally near. r: too far. s: nearer to another feature of the first image.
  const AppearanceVector a = image_of({p, q, r, s, bits.near(s, 12)});
  const AppearanceVector b =
      image_of({bits.near(p, 6), bits.near(q, 8), bits.near(q, 8), bits.near(r, 29), bits.near(s, 2)});
  const auto matches = signature_matches(a, b, 0, {});
  EXPECT_THAT(matches, ElementsAre(FeatureMatch{0, 0}, FeatureMatch{3, 4}));
  EXPECT_THAT(signature_matches(b, a, 0, {}), ElementsAre(FeatureMatch{0, 0}, FeatureMatch{4, 3}));
}

TEST(SignatureMatches, TurnWithTheImage) {
  test::Bits bits(9);
  std::vector<Signature> signatures;
  for (int i = 0; i < 36; ++i) signatures.push_back(bits.signature());
  AppearanceVector a = image_of(signatures), b = image_of(signatures);
  for (std::size_t i = 0; i < 36; ++i) {
    a.appearances[i].angle_deg = 10.0f * static_cast<float>(i);
    b.appearances[i].angle_deg = static_cast<float>((10 * i + 250) % 360);
  }
  for (const float turn_deg : {250.0f, -110.0f, 275.0f, 225.0f}) {
    const auto matches = signature_matches(a, b, turn_deg, {});
    ASSERT_EQ(matches.size(), 36u) << turn_deg;
    for (std::uint16_t i = 0; i < 36; ++i) EXPECT_EQ(matches[i], (FeatureMatch{i, i}));
  }
  for (const float turn_deg : {0.0f, 200.0f, 300.0f, -180.0f}) {
    EXPECT_THAT(signature_matches(a, b, turn_deg, {}), IsEmpty()) << turn_deg;
  }
}

TEST(SignatureMatches, OfOneWordAreKeptWhenNear) {
  test::Bits bits(6);
  const Signature p = bits.signature(), q = bits.signature();
  const AppearanceVector a = image_of({p, q});
  const AppearanceVector b = image_of({bits.near(p, 28), bits.near(q, 29)});
  EXPECT_THAT(with_near_signatures(a, b, {{0, 0}, {1, 1}}, {}), ElementsAre(FeatureMatch{0, 0}));
}

TEST(CommonTurns, AreThoseOfMostMatches) {
  AppearanceVector a = image_of(std::vector<Signature>(6)), b = a;
  std::vector<FeatureMatch> matches;
  const std::vector<float> turns_deg{340, 355, 4, 100, 101, 180};
  for (std::uint16_t i = 0; i < 6; ++i) {
    a.appearances[i].angle_deg = 350.0f - 50.0f * static_cast<float>(i);
    b.appearances[i].angle_deg =
        a.appearances[i].angle_deg + turns_deg[i] - (a.appearances[i].angle_deg + turns_deg[i] >= 360 ? 360.0f : 0.0f);
    matches.push_back({i, i});
  }
  // 355 and 4 lie within 22.5 degrees around 0, as 100 and 101 do around 101.25; with 340 there would be three.
  EXPECT_EQ(common_turn(a, b, matches).agreeing, 2u);
  b.appearances[3].angle_deg = a.appearances[3].angle_deg + 2;
  const CommonTurn turn = common_turn(a, b, matches);
  EXPECT_EQ(turn.agreeing, 3u);
  EXPECT_EQ(turn.turn_deg, 360.0f);
  EXPECT_EQ(common_turn(a, b, {}).agreeing, 0u);
}

// ---- In the verifier ----------------------------------------------------------------------------------------------

TEST(SignaturesInTheVerifier, FindWhatWordsMiss) {
  const EpipolarVerifier verifier;
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    // 60 points seen twice; 8 of them by one word.
    const test::SignedScene scene = test::signed_scene({.seed = seed, .points = 60}, 8, 12);
    const Verification with = verifier.verify(scene.a, scene.b);
    const Verification without = verifier.verify(test::unsigned_image(scene.a), test::unsigned_image(scene.b));
    EXPECT_TRUE(with.accepted) << seed << ' ' << with.inliers;
    EXPECT_GE(with.inliers, 45) << seed;
    EXPECT_FALSE(without.accepted) << seed;
    for (const auto& m : with.inlier_matches) EXPECT_TRUE(scene.true_matches.contains(m)) << seed;
  }
}

TEST(SignaturesInTheVerifier, UnmaskEqualWords) {
  const EpipolarVerifier verifier;
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    // The same words at the same places, but nothing looks alike.
    test::SignedScene scene = test::signed_scene({.seed = seed, .points = 60}, 60, 12);
    EXPECT_TRUE(verifier.verify(scene.a, scene.b).accepted) << seed;
    test::Bits bits(seed);
    for (Appearance& appearance : scene.b.appearances) appearance.signature = bits.signature();
    EXPECT_FALSE(verifier.verify(scene.a, scene.b).accepted) << seed;
  }
}

TEST(SignaturesInTheVerifier, AThingAloneIsRefusedWhenNothingAroundItMatches) {
  const EpipolarVerifier verifier;
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    // The same thirty matches, among few other features and among many.
    const test::SignedScene alone =
        test::signed_scene({.seed = seed, .points = 30, .outliers = 0, .clutter = 40}, 30, 8);
    const test::SignedScene lost =
        test::signed_scene({.seed = seed, .points = 30, .outliers = 0, .clutter = 700}, 30, 8);
    EXPECT_TRUE(verifier.verify(alone.a, alone.b).accepted) << seed;
    const Verification refused = verifier.verify(lost.a, lost.b);
    EXPECT_FALSE(refused.accepted) << seed;
    EXPECT_EQ(refused.reason, Reason::kInconsistent) << seed;
    EXPECT_TRUE(EpipolarVerifier({.signatures = false}).verify(lost.a, lost.b).accepted) << seed << ": words would";
  }
}

// Enough of the matches agree with others for a geometry to be looked for; what it leaves is too little. Some of the
// things have moved together between the two views, so that they support each other and no common geometry.
TEST(SignaturesInTheVerifier, AThingIsRefusedWhenTheGeometryLeavesTooFewAroundIt) {
  const EpipolarVerifier verifier;
  int refused_at_the_end = 0, accepted = 0;
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    for (const int clutter : {300, 560, 620, 680}) {
      test::SignedScene scene =
          test::signed_scene({.seed = seed, .points = 40, .outliers = 0, .clutter = clutter, .flat = true}, 40, 8);
      int moved = 0;
      for (const auto& [i, j] : scene.true_matches) {
        if (moved < 6) scene.b.appearances[j].y_px += scene.b.appearances[j].y_px < 200 ? 40 : -40;
        if (moved >= 6 && moved < 12) scene.b.appearances[j].x_px += scene.b.appearances[j].x_px < 200 ? 40 : -40;
        ++moved;
      }
      std::ranges::sort(scene.b.appearances);
      const Verification v = verifier.verify(scene.a, scene.b);
      const double share = view_overlap(scene.a, scene.b, v.inlier_matches).matched_share;
      EXPECT_EQ(matched_share(FeaturePlaces(scene.a), FeaturePlaces(scene.b), v.inlier_matches), share);
      // Only the last of the tests has inliers to show.
      if (v.reason == Reason::kInconsistent && v.inliers >= 10 && !v.inlier_matches.empty()) {
        ++refused_at_the_end;
        EXPECT_LT(share, 0.06);
      }
      if (v.accepted) {
        ++accepted;
        EXPECT_GE(share, 0.06) << seed << ' ' << clutter;
      }
    }
  }
  EXPECT_GT(refused_at_the_end, 3);
  EXPECT_GT(accepted, 3);
}

TEST(SignaturesInTheVerifier, AreLeftOutWhenOneImageHasNone) {
  const EpipolarVerifier verifier;
  const test::SignedScene scene = test::signed_scene({.seed = 3, .points = 60}, 60, 12);
  const AppearanceVector old = test::unsigned_image(scene.b);
  Verification mixed = verifier.verify(scene.a, old);
  Verification neither = verifier.verify(test::unsigned_image(scene.a), old);
  EXPECT_TRUE(mixed.accepted);
  EXPECT_EQ(mixed.matches, neither.matches);
  EXPECT_EQ(mixed.inlier_matches, neither.inlier_matches);
}

TEST(SignaturesInTheVerifier, AreLeftOutWhenOneAsksForWordsAlone) {
  const EpipolarVerifier by_words({.signatures = false});
  EXPECT_NE(by_words.version(), EpipolarVerifier().version());
  const test::SignedScene scene = test::signed_scene({.seed = 3, .points = 60}, 40, 12);
  EXPECT_EQ(by_words.verify(scene.a, scene.b).inlier_matches,
            EpipolarVerifier().verify(test::unsigned_image(scene.a), test::unsigned_image(scene.b)).inlier_matches);
}

TEST(SignaturesInTheVerifier, GiveTheMirroredVerdictFromTheOtherSide) {
  const EpipolarVerifier verifier;
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    const test::SignedScene scene = test::signed_scene({.seed = seed, .points = 60, .repeats = 6}, 20, 14);
    const Verification ab = verifier.verify(scene.a, scene.b);
    const Verification ba = mirrored(verifier.verify(scene.b, scene.a));
    EXPECT_EQ(ab.inlier_matches, ba.inlier_matches) << seed;
    EXPECT_EQ(ab.log10_false_alarms, ba.log10_false_alarms) << seed;
    EXPECT_EQ(ab.accepted, ba.accepted) << seed;
  }
}

TEST(SignaturesInTheVerifier, ChanceIsRefused) {
  const EpipolarVerifier verifier;
  for (std::uint64_t seed = 1; seed <= 2'000; ++seed) {
    auto [a, b] = test::make_chance_pair({.seed = seed, .matches = 12 + static_cast<int>(seed % 100)});
    test::Bits bits(seed);
    for (Appearance& appearance : a.appearances) appearance.signature = bits.signature();
    for (std::size_t i = 0; i < b.appearances.size(); ++i) {
      b.appearances[i].signature = bits.near(a.appearances[i].signature, 10);
    }
    EXPECT_FALSE(verifier.verify(a, b).accepted) << seed;
  }
}

}  // namespace
}  // namespace mapweld
