// Word matches, the support they give each other, and the choice of one match a location.
#include <algorithm>
#include <cmath>
#include <iterator>
#include <random>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/geometry/correspondences.h"
#include "core/geometry/one_to_one.h"
#include "core/geometry/similarity_support.h"
#include "core/geometry/spatial_consistency.h"
#include "core/geometry/word_matches.h"
#include "tests/core/geometry/two_view_scene.h"

namespace mapweld {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

AppearanceVector with_words(const std::vector<std::uint32_t>& words) {
  AppearanceVector image{.width_px = 320, .height_px = 240, .appearances = {}};
  float x = 0;
  for (const std::uint32_t w : words) image.appearances.push_back({WordId{w}, x += 5, 10, 4, 0});
  return image;
}

TEST(WordMatches, AreAllPairingsOfEqualWords) {
  const auto matches = word_matches(with_words({1, 2, 2, 5, 9}), with_words({2, 2, 2, 3, 5}), 9, 600);
  EXPECT_THAT(matches, ElementsAre(FeatureMatch{1, 0}, FeatureMatch{1, 1}, FeatureMatch{1, 2}, FeatureMatch{2, 0},
                                   FeatureMatch{2, 1}, FeatureMatch{2, 2}, FeatureMatch{3, 4}));
}

TEST(WordMatches, LeaveOutTextures) {
  const AppearanceVector a = with_words({1, 2, 2, 5, 9});
  const AppearanceVector b = with_words({2, 2, 2, 3, 5});
  EXPECT_THAT(word_matches(a, b, 5, 600), ElementsAre(FeatureMatch{3, 4}));
  EXPECT_THAT(word_matches(a, b, 9, 6), ElementsAre(FeatureMatch{3, 4})) << "the commonest words go first";
  EXPECT_THAT(word_matches(a, b, 9, 0), IsEmpty());
}

TEST(SimilaritySupport, CountsWhoAgrees) {
  const test::TwoViewScene scene = test::make_scene({.seed = 3, .outliers = 40, .repeats = 10, .roll_deg = 20});
  const auto matches = word_matches(scene.a, scene.b, 9, 600);
  const Correspondences c = make_correspondences(scene.a, scene.b, matches);
  const SimilaritySupportOptions options;
  const auto support = similarity_support(c, options);
  // By angles and logarithms, as the header's words say it.
  for (std::size_t i = 0; i < c.size(); ++i) {
    const double turn = std::atan2(c.m_im[i], c.m_re[i]);
    int agreeing = 0;
    int borderline = 0;
    for (std::size_t j = 0; j < c.size(); ++j) {
      if (j == i) continue;
      const double difference = std::remainder(std::atan2(c.m_im[j], c.m_re[j]) - turn, 2 * M_PI);
      const double octaves = std::log(c.ratio[j] / c.ratio[i]);
      const double dx = c.xa[j] - c.xa[i];
      const double dy = c.ya[j] - c.ya[i];
      const double px = c.ratio[i] * (std::cos(turn) * dx - std::sin(turn) * dy);
      const double py = c.ratio[i] * (std::sin(turn) * dx + std::cos(turn) * dy);
      const double distance = std::hypot(c.xb[j] - c.xb[i], c.yb[j] - c.yb[i]);
      const double miss = std::hypot(px - (c.xb[j] - c.xb[i]), py - (c.yb[j] - c.yb[i]));
      const double allowed = std::hypot(options.slack, options.relative_slack * distance);
      const double margins[3] = {std::acos(options.max_turn_cos) - std::fabs(difference),
                                 std::log(options.max_ratio) - std::fabs(octaves), allowed - miss};
      const double least = std::min({margins[0], margins[1], margins[2]});
      agreeing += least > 1e-5;
      borderline += std::fabs(least) <= 1e-5;
    }
    EXPECT_GE(support[i], agreeing);
    EXPECT_LE(support[i], agreeing + borderline);
  }
}

TEST(SimilaritySupport, TellsTrueMatchesFromOutliers) {
  const test::TwoViewScene scene = test::make_scene({.seed = 4, .points = 60, .outliers = 60});
  const auto matches = word_matches(scene.a, scene.b, 9, 600);
  const auto support = similarity_support(make_correspondences(scene.a, scene.b, matches), {});
  double of_true = 0;
  double of_outliers = 0;
  for (std::size_t i = 0; i < matches.size(); ++i) {
    (scene.true_matches.contains({matches[i].a, matches[i].b}) ? of_true : of_outliers) += support[i] / 60.0;
  }
  EXPECT_GT(of_true, 5 * of_outliers);
}

TEST(OneToOne, KeepsTheBestSupportedOfEachLocation) {
  AppearanceVector a = with_words({1, 1, 2});
  AppearanceVector b = with_words({1, 1, 2});
  b.appearances[2].x_px = b.appearances[0].x_px + 0.5f;  // word 2 lies where the first of word 1 does
  const std::vector<FeatureMatch> matches{{0, 0}, {0, 1}, {1, 0}, {1, 1}, {2, 2}};
  EXPECT_THAT(one_to_one(a, b, matches, {1, 5, 4, 1, 2}), ElementsAre(1u, 2u));
  EXPECT_THAT(one_to_one(a, b, matches, {1, 1, 1, 1, 9}), ElementsAre(1u, 4u));
  EXPECT_THAT(one_to_one(a, b, matches, {0, 0, 0, 0, 0}), ElementsAre(0u, 3u));
}

TEST(SpatialConsistency, KeepsMatchesWhoseNeighboursAgree) {
  // A patch of 25 matches that moves as one, and one match that leaves it.
  Correspondences c;
  const auto add = [&](float xa, float ya, float xb, float yb) {
    c.xa.push_back(xa);
    c.ya.push_back(ya);
    c.xb.push_back(xb);
    c.yb.push_back(yb);
  };
  for (int i = 0; i < 25; ++i) {
    const float x = 0.02f * static_cast<float>(i % 5);
    const float y = 0.02f * static_cast<float>(i / 5);
    add(x, y, x + 0.2f, y + 0.1f);
  }
  // A second patch of 25, far away, and a match from the middle of the first into the middle of the second.
  for (int i = 0; i < 25; ++i) {
    const float x = 0.4f + 0.02f * static_cast<float>(i % 5);
    const float y = 0.3f + 0.02f * static_cast<float>(i / 5);
    add(x, y, x + 0.2f, y + 0.1f);
  }
  add(0.041f, 0.041f, 0.641f, 0.441f);
  std::vector<std::uint32_t> all(51);
  for (std::uint32_t i = 0; i < 51; ++i) all[i] = i;
  const auto kept = spatially_consistent(c, all, {.neighbours = 8, .min_support = 3});
  EXPECT_EQ(kept, std::vector<std::uint32_t>(all.begin(), all.begin() + 50));
  EXPECT_THAT(spatially_consistent(c, {}, {}), IsEmpty());
}

// The nearest of match `i` in one image, by sorting: ties go to the lower index.
std::vector<std::size_t> nearest_by_sorting(const std::vector<float>& x, const std::vector<float>& y, std::size_t i,
                                            std::size_t count) {
  std::vector<std::pair<float, std::size_t>> others;
  for (std::size_t j = 0; j < x.size(); ++j) {
    const float dx = x[j] - x[i], dy = y[j] - y[i];
    if (j != i) others.emplace_back(dx * dx + dy * dy, j);
  }
  std::ranges::sort(others);
  std::vector<std::size_t> nearest;
  for (std::size_t k = 0; k < count; ++k) nearest.push_back(others[k].second);
  std::ranges::sort(nearest);
  return nearest;
}

TEST(SpatialConsistency, CountsNeighboursInBothImagesHoweverManyAreEquallyFar) {
  std::mt19937 random(5);
  std::size_t kept_in_all = 0;
  for (const std::size_t n : {2u, 3u, 7u, 8u, 9u, 16u, 19u, 20u, 21u, 50u}) {
    for (const std::uint32_t grid : {4u, 1000u}) {  // on the coarse one most distances are equal
      Correspondences c;
      std::vector<std::uint32_t> all;
      for (std::uint32_t i = 0; i < n; ++i) {
        all.push_back(i);
        c.xa.push_back(static_cast<float>(random() % grid) / static_cast<float>(grid));
        c.ya.push_back(static_cast<float>(random() % grid) / static_cast<float>(grid));
        const bool stays = random() % 4 != 0;
        c.xb.push_back(stays ? c.xa.back() + 0.25f : static_cast<float>(random() % grid) / static_cast<float>(grid));
        c.yb.push_back(stays ? c.ya.back() : static_cast<float>(random() % grid) / static_cast<float>(grid));
      }
      std::vector<std::uint32_t> expected;
      const std::size_t count = std::min<std::size_t>(10, n / 2);
      for (std::uint32_t i = 0; i < n; ++i) {
        std::vector<std::size_t> both;
        std::ranges::set_intersection(nearest_by_sorting(c.xa, c.ya, i, count),
                                      nearest_by_sorting(c.xb, c.yb, i, count), std::back_inserter(both));
        if (both.size() >= 3) expected.push_back(i);
      }
      EXPECT_EQ(spatially_consistent(c, all, {}), expected) << n << " on " << grid;
      kept_in_all += expected.size();
    }
  }
  EXPECT_GT(kept_in_all, 50u);
}

}  // namespace
}  // namespace mapweld
