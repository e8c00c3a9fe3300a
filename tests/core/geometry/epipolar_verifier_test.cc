#include "core/geometry/epipolar_verifier.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <thread>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "core/retrieval/voting.h"
#include "tests/core/geometry/signed_scene.h"
#include "tests/core/geometry/two_view_scene.h"

namespace mapweld {
namespace {

using test::make_scene;
using test::SceneOptions;
using test::TwoViewScene;

int true_inliers(const Verification& v, const TwoViewScene& scene) {
  return static_cast<int>(
      std::ranges::count_if(v.inlier_matches, [&](const auto& m) { return scene.true_matches.contains(m); }));
}

double mean_distance_px(const Verification& v, const TwoViewScene& scene) {
  double sum = 0;
  for (const auto& [i, j] : scene.true_matches) {
    const Appearance& p = scene.a.appearances[i];
    const Appearance& q = scene.b.appearances[j];
    sum += v.kind == GeometryKind::kHomography ? test::transfer_distance_px(v.geometry, p, q)
                                               : test::epipolar_distance_px(v.geometry, p, q);
  }
  return sum / static_cast<double>(scene.true_matches.size());
}

void expect_mirror(const Verification& ab, const Verification& ba) {
  const Verification m = mirrored(ba);
  EXPECT_EQ(ab.accepted, m.accepted);
  EXPECT_EQ(ab.reason, m.reason);
  EXPECT_EQ(ab.matches, m.matches);
  EXPECT_EQ(ab.inliers, m.inliers);
  EXPECT_EQ(ab.log10_false_alarms, m.log10_false_alarms);
  EXPECT_EQ(ab.kind, m.kind);
  EXPECT_EQ(ab.inlier_matches, m.inlier_matches);
  if (ab.kind == GeometryKind::kHomography) {
    double sign = 0;
    for (int k = 0; k < 9; ++k) sign += ab.geometry[k] * m.geometry[k];
    for (int k = 0; k < 9; ++k) EXPECT_NEAR(ab.geometry[k], std::copysign(1.0, sign) * m.geometry[k], 1e-9);
  } else {
    EXPECT_EQ(ab.geometry, m.geometry);
  }
}

class DeepScene : public testing::TestWithParam<SceneOptions> {};
INSTANTIATE_TEST_SUITE_P(Motions, DeepScene,
                         testing::Values(SceneOptions{.seed = 1}, SceneOptions{.seed = 2, .outliers = 60},
                                         SceneOptions{.seed = 3, .forward_m = 1.0, .sideways_m = 0, .pan_deg = 0},
                                         SceneOptions{.seed = 4, .forward_m = 0, .sideways_m = 0.8},
                                         SceneOptions{.seed = 5, .points = 150, .outliers = 100, .roll_deg = 30},
                                         SceneOptions{.seed = 6, .roll_deg = 180},
                                         SceneOptions{.seed = 7, .scale_b = 2},
                                         SceneOptions{.seed = 8, .repeats = 20}));

TEST_P(DeepScene, IsAcceptedWithItsEpipolarGeometry) {
  const TwoViewScene scene = make_scene(GetParam());
  const Verification v = EpipolarVerifier().verify(scene.a, scene.b);
  EXPECT_TRUE(v.accepted) << to_string(v.reason) << ' ' << v.inliers << ' ' << v.log10_false_alarms;
  EXPECT_EQ(v.reason, Reason::kNone);
  EXPECT_EQ(v.kind, GeometryKind::kFundamental);
  EXPECT_EQ(v.inliers, static_cast<int>(v.inlier_matches.size()));
  EXPECT_GE(true_inliers(v, scene), 0.7 * static_cast<double>(scene.true_matches.size()));
  EXPECT_GE(true_inliers(v, scene), 0.9 * v.inliers);
  EXPECT_LT(mean_distance_px(v, scene), 1.5 * GetParam().scale_b);
  EXPECT_LT(v.log10_false_alarms, -10);
}

class FlatScene : public testing::TestWithParam<SceneOptions> {};
INSTANTIATE_TEST_SUITE_P(
    Motions, FlatScene,
    testing::Values(SceneOptions{.seed = 11, .flat = true}, SceneOptions{.seed = 12, .outliers = 80, .flat = true},
                    SceneOptions{.seed = 13, .points = 14, .outliers = 5, .flat = true},
                    SceneOptions{.seed = 14, .flat = true, .forward_m = 1.5, .sideways_m = 1.5, .pan_deg = -10},
                    // a camera that only turned sees no parallax, however deep the scene
                    SceneOptions{.seed = 15, .forward_m = 0, .sideways_m = 0, .pan_deg = 12},
                    SceneOptions{.seed = 16, .forward_m = 0, .sideways_m = 0, .pan_deg = 0, .roll_deg = 90}));

TEST_P(FlatScene, IsAcceptedWithItsHomography) {
  const TwoViewScene scene = make_scene(GetParam());
  const Verification v = EpipolarVerifier().verify(scene.a, scene.b);
  EXPECT_TRUE(v.accepted) << to_string(v.reason) << ' ' << v.inliers << ' ' << v.log10_false_alarms;
  EXPECT_EQ(v.kind, GeometryKind::kHomography);
  EXPECT_GE(true_inliers(v, scene), 0.8 * static_cast<double>(scene.true_matches.size()));
  EXPECT_GE(true_inliers(v, scene), 0.9 * v.inliers);
  EXPECT_LT(mean_distance_px(v, scene), 1.0);
}

TEST(EpipolarVerifier, IsSymmetric) {
  const EpipolarVerifier verifier;
  for (std::uint64_t seed = 100; seed < 160; ++seed) {
    const int points = static_cast<int>(seed % 7) * 8;
    const TwoViewScene scene =
        make_scene({.seed = seed, .points = points, .outliers = 60, .repeats = 10, .flat = seed % 2 == 0});
    expect_mirror(verifier.verify(scene.a, scene.b), verifier.verify(scene.b, scene.a));
    const auto [p, q] = test::make_chance_pair({.seed = seed, .matches = 150});
    expect_mirror(verifier.verify(p, q), verifier.verify(q, p));
  }
}

// Prepared images of all scenes, each in many pairs, asked for by several threads at once.
TEST(EpipolarVerifier, PreparedImagesAreGivenTheSameVerdicts) {
  const EpipolarVerifier verifier;
  std::vector<AppearanceVector> images;
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    const test::SignedScene scene =
        test::signed_scene({.seed = seed, .points = 60, .outliers = 40, .repeats = 10}, 30, 10);
    images.push_back(scene.a);
    images.push_back(scene.b);
    images.push_back(seed % 2 == 0 ? test::unsigned_image(scene.b) : scene.b);
    if (seed % 3 == 0) std::swap(images.back().static_appearances, images.back().appearances);
  }
  images.push_back({320, 240, {}});
  std::vector<std::shared_ptr<const PreparedImage>> prepared;
  for (const AppearanceVector& image : images) {
    prepared.push_back(verifier.prepare(std::make_shared<AppearanceVector>(image)));
  }
  std::vector<int> different(4, 0), accepted(4, 0);
  std::vector<std::thread> threads;
  for (std::size_t t = 0; t < different.size(); ++t) {
    threads.emplace_back([&, t] {
      for (std::size_t k = 0; k < images.size() * images.size(); ++k) {
        const std::size_t i = (k + t) % images.size(), j = k / images.size();
        const Verification v = verifier.verify_prepared(*prepared[i], *prepared[j]);
        different[t] += v != verifier.verify(images[i], images[j]) ? 1 : 0;
        accepted[t] += v.accepted ? 1 : 0;
      }
    });
  }
  for (std::thread& t : threads) t.join();
  EXPECT_EQ(different, std::vector<int>(4, 0));
  EXPECT_GT(accepted[0], 20);
}

TEST(EpipolarVerifier, VerdictsDoNotDependOnThreadsOrOnWhatWentBefore) {
  const EpipolarVerifier verifier;
  std::vector<TwoViewScene> scenes;
  std::vector<Verification> alone;
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    scenes.push_back(make_scene({.seed = seed, .points = 5 + 2 * static_cast<int>(seed), .outliers = 40}));
    alone.push_back(EpipolarVerifier().verify(scenes.back().a, scenes.back().b));
  }
  std::vector<int> different(4, 0);
  std::vector<std::thread> threads;
  for (std::size_t t = 0; t < different.size(); ++t) {
    threads.emplace_back([&, t] {
      for (std::size_t i = 0; i < scenes.size(); ++i) {
        const std::size_t k = (7 * i + 11 * t) % scenes.size();
        different[t] += verifier.verify(scenes[k].a, scenes[k].b) != alone[k];
      }
    });
  }
  for (std::thread& t : threads) t.join();
  EXPECT_EQ(different, std::vector<int>(4, 0));
}

TEST(EpipolarVerifier, AnImageVerifiesAgainstItself) {
  const TwoViewScene scene = make_scene({.seed = 21, .repeats = 20});
  const Verification v = EpipolarVerifier().verify(scene.a, scene.a);
  EXPECT_TRUE(v.accepted);
  EXPECT_EQ(v.kind, GeometryKind::kHomography);
  EXPECT_GE(v.inliers, 0.9 * static_cast<double>(scene.a.appearances.size()));
  for (const auto& [i, j] : v.inlier_matches) EXPECT_EQ(i, j);
}

TEST(EpipolarVerifier, InliersAreOneToOneAndOneALocation) {
  for (std::uint64_t seed = 30; seed < 40; ++seed) {
    TwoViewScene scene = make_scene({.seed = seed, .repeats = 30});
    // SIFT's further orientations: the same place again under another word.
    for (AppearanceVector* image : {&scene.a, &scene.b}) {
      std::vector<Appearance> more;
      for (const Appearance& p : image->appearances) {
        if (to_index(p.word) % 4 != 0) continue;
        more.push_back(p);
        more.back().word = WordId{to_index(p.word) + 100000};
        more.back().angle_deg = std::fmod(p.angle_deg + 90, 360.0f);
      }
      image->appearances.insert(image->appearances.end(), more.begin(), more.end());
      std::ranges::sort(image->appearances);
    }
    const Verification v = EpipolarVerifier().verify(scene.a, scene.b);
    EXPECT_TRUE(v.accepted);
    for (std::size_t i = 0; i < v.inlier_matches.size(); ++i) {
      for (std::size_t j = i + 1; j < v.inlier_matches.size(); ++j) {
        const auto apart = [](const Appearance& p, const Appearance& q) {
          return std::hypot(p.x_px - q.x_px, p.y_px - q.y_px) >= 1;
        };
        EXPECT_TRUE(
            apart(scene.a.appearances[v.inlier_matches[i].first], scene.a.appearances[v.inlier_matches[j].first]));
        EXPECT_TRUE(
            apart(scene.b.appearances[v.inlier_matches[i].second], scene.b.appearances[v.inlier_matches[j].second]));
      }
    }
    EXPECT_LE(v.inliers, static_cast<int>(pair_votes(scene.a, scene.b, VoteRule::kMin)));
  }
}

TEST(EpipolarVerifier, RepeatedWordsFindTheirPartners) {
  const TwoViewScene scene = make_scene({.seed = 41, .points = 60, .outliers = 0, .repeats = 20});
  const Verification v = EpipolarVerifier().verify(scene.a, scene.b);
  ASSERT_TRUE(v.accepted);
  EXPECT_GE(true_inliers(v, scene), 48);
}

TEST(EpipolarVerifier, BlankAndPoorImagesHaveTooFewFeatures) {
  const TwoViewScene scene = make_scene({.seed = 51});
  const AppearanceVector blank{.width_px = 320, .height_px = 240, .appearances = {}};
  AppearanceVector poor = scene.a;
  poor.appearances.resize(9);
  const EpipolarVerifier verifier;
  for (const AppearanceVector& image : {blank, poor, AppearanceVector{}}) {
    const Verification v = verifier.verify(image, scene.b);
    EXPECT_FALSE(v.accepted);
    EXPECT_EQ(v.reason, Reason::kTooFewFeatures);
    EXPECT_EQ(v.matches, 0);
    EXPECT_EQ(verifier.verify(scene.b, image).reason, Reason::kTooFewFeatures);
    EXPECT_EQ(verifier.verify(image, image).reason, Reason::kTooFewFeatures);
  }
}

TEST(EpipolarVerifier, ImagesWithoutCommonWordsHaveTooFewInliers) {
  const TwoViewScene scene = make_scene({.seed = 52});
  const TwoViewScene other = make_scene({.seed = 53, .first_word = 1000000});
  const Verification v = EpipolarVerifier().verify(scene.a, other.b);
  EXPECT_FALSE(v.accepted);
  EXPECT_EQ(v.reason, Reason::kTooFewInliers);
  EXPECT_EQ(v.matches, 0);
  EXPECT_EQ(v.inliers, 0);
}

TEST(EpipolarVerifier, OptionsDecide) {
  const TwoViewScene scene = make_scene({.seed = 54, .points = 40});
  const Verification v = EpipolarVerifier().verify(scene.a, scene.b);
  ASSERT_TRUE(v.accepted);
  EXPECT_TRUE(EpipolarVerifier({.min_inliers = v.inliers}).verify(scene.a, scene.b).accepted);
  const Verification more = EpipolarVerifier({.min_inliers = v.inliers + 1}).verify(scene.a, scene.b);
  EXPECT_FALSE(more.accepted);
  EXPECT_TRUE(more.reason == Reason::kTooFewInliers || more.reason == Reason::kInconsistent);
  const double below = std::pow(10, v.log10_false_alarms - 1);
  const Verification rarer = EpipolarVerifier({.max_false_alarms = below}).verify(scene.a, scene.b);
  EXPECT_FALSE(rarer.accepted);
  EXPECT_EQ(rarer.reason, Reason::kNotSignificant);
  EXPECT_EQ(rarer.inlier_matches, v.inlier_matches);
  EXPECT_EQ(rarer.log10_false_alarms, v.log10_false_alarms);
}

TEST(EpipolarVerifier, InliersThatFallApartAreInconsistent) {
  const EpipolarVerifier verifier;
  int inconsistent = 0;
  for (std::uint64_t seed = 0; seed < 60; ++seed) {
    const auto [a, b] = test::make_chance_pair({.seed = seed, .matches = 150});
    const Verification v = verifier.verify(a, b);
    if (v.reason != Reason::kInconsistent) continue;
    ++inconsistent;
    EXPECT_FALSE(v.accepted);
    EXPECT_LT(v.inliers, 10);
    EXPECT_EQ(v.inliers, static_cast<int>(v.inlier_matches.size()));
  }
  EXPECT_GT(inconsistent, 0);
}

TEST(Mirrored, SwapsMatchesAndTransposesGeometry) {
  Verification v;
  v.kind = GeometryKind::kFundamental;
  v.geometry = {1, 2, 3, 4, 5, 6, 7, 8, 9};
  v.inlier_matches = {{1, 9}, {2, 4}, {3, 7}};
  const Verification m = mirrored(v);
  EXPECT_EQ(m.geometry, (std::array<double, 9>{1, 4, 7, 2, 5, 8, 3, 6, 9}));
  const std::vector<std::pair<std::uint16_t, std::uint16_t>> swapped{{4, 2}, {7, 3}, {9, 1}};
  EXPECT_EQ(m.inlier_matches, swapped);
  EXPECT_EQ(mirrored(m), v);
}

// The same scene, its features drawn together to a share of the image: one small object, seen twice.
AppearanceVector shrunk(AppearanceVector image, float share) {
  const float cx = 0.5f * static_cast<float>(image.width_px);
  const float cy = 0.5f * static_cast<float>(image.height_px);
  for (Appearance& p : image.appearances) {
    p.x_px = std::round(8 * (cx + share * (p.x_px - cx))) / 8;
    p.y_px = std::round(8 * (cy + share * (p.y_px - cy))) / 8;
    p.scale_px *= share;
  }
  std::ranges::sort(image.appearances);
  return image;
}

TEST(EpipolarVerifier, OneSmallObjectIsNoPlace) {
  const TwoViewScene scene =
      make_scene({.seed = 61, .points = 40, .outliers = 0, .clutter = 0, .noise_px = 0, .flat = true});
  const EpipolarVerifier verifier;
  const Verification whole = verifier.verify(scene.a, scene.b);
  ASSERT_TRUE(whole.accepted);
  const Verification small = verifier.verify(shrunk(scene.a, 0.12f), shrunk(scene.b, 0.12f));
  EXPECT_FALSE(small.accepted);
  EXPECT_EQ(small.reason, Reason::kNotSignificant);
  EXPECT_GE(small.inliers, 10);
  // Small in one image only: somebody went closer.
  EXPECT_TRUE(verifier.verify(shrunk(scene.a, 0.4f), scene.b).accepted);
}

// docs/verification.md reports 100,000 pairs of each layout; here is a sample of them.
TEST(EpipolarVerifier, ChanceIsNotAccepted) {
  const EpipolarVerifier verifier({.min_inliers = kFewestInliers});
  for (const test::Layout layout :
       {test::Layout::kUniform, test::Layout::kGrid, test::Layout::kShelves, test::Layout::kCluster}) {
    for (const bool equal_frames : {false, true}) {
      double lowest = 300;
      for (std::uint64_t seed = 0; seed < 250; ++seed) {
        const int matches = 12 + static_cast<int>((seed * 7919) % 289);
        const auto [a, b] =
            test::make_chance_pair({.seed = seed, .matches = matches, .layout = layout, .equal_frames = equal_frames});
        const Verification v = verifier.verify(a, b);
        EXPECT_FALSE(v.accepted) << static_cast<int>(layout) << ' ' << equal_frames << ' ' << matches;
        lowest = std::min(lowest, v.log10_false_alarms);
      }
      EXPECT_GT(lowest, 0) << "a false alarm in a thousand was to be expected at most once in a thousand";
    }
  }
}

}  // namespace
}  // namespace mapweld
