// Fundamental matrices and homographies, against the truth of made scenes and against OpenCV.
#include "core/geometry/two_view_geometry.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>
#include <vector>

#include <gtest/gtest.h>
#include <opencv2/calib3d.hpp>

#include "core/geometry/false_alarms.h"
#include "core/geometry/fundamental_matrix.h"
#include "core/geometry/homography.h"
#include "core/geometry/robust_fundamental.h"
#include "core/geometry/word_matches.h"
#include "tests/core/geometry/two_view_scene.h"

namespace mapweld {
namespace {

using test::make_scene;
using test::TwoViewScene;

Correspondences correspondences_of(const TwoViewScene& scene) {
  return make_correspondences(scene.a, scene.b, word_matches(scene.a, scene.b, 9, 600));
}

// Distance of two matrices that are known up to scale and sign.
double distance_up_to_scale(const double* p, const double* q) {
  double pp = 0, qq = 0, pq = 0;
  for (int k = 0; k < 9; ++k) {
    pp += p[k] * p[k];
    qq += q[k] * q[k];
    pq += p[k] * q[k];
  }
  return std::sqrt(std::max(0.0, 2 - 2 * std::fabs(pq) / std::sqrt(pp * qq)));
}

TEST(FundamentalMatrix, SevenPointSolutionsAreThoseOfOpenCv) {
  std::mt19937_64 random(1);
  int compared = 0;
  for (std::uint64_t seed = 0; seed < 50; ++seed) {
    const Correspondences c = correspondences_of(make_scene({.seed = seed, .points = 30, .outliers = 10}));
    std::vector<std::uint32_t> order(c.size());
    std::iota(order.begin(), order.end(), 0u);
    std::array<std::uint32_t, 7> sample;
    std::vector<cv::Point2d> pa, pb;
    for (std::size_t i = 0; i < 7; ++i) {
      std::swap(order[i], order[i + random() % (order.size() - i)]);
      sample[i] = order[i];
      pa.emplace_back(c.xa[order[i]], c.ya[order[i]]);
      pb.emplace_back(c.xb[order[i]], c.yb[order[i]]);
    }
    std::array<Matrix3, 3> found;
    const int n = fundamental_from_seven(c, sample, found);
    const cv::Mat theirs = cv::findFundamentalMat(pa, pb, cv::FM_7POINT);
    ASSERT_EQ(n, theirs.rows / 3);
    for (int s = 0; s < n; ++s) {
      EXPECT_NEAR(determinant(found[s]), 0, 1e-9);
      double nearest = 2;
      for (int t = 0; t < n; ++t) {
        nearest = std::min(nearest, distance_up_to_scale(found[s].data(), theirs.ptr<double>(3 * t)));
      }
      EXPECT_LT(nearest, 1e-5);
      std::vector<float> d2;
      epipolar_distances2(c, found[s], d2);
      for (const std::uint32_t i : sample) EXPECT_LT(d2[i], 1e-8);
      ++compared;
    }
  }
  EXPECT_GT(compared, 50);
}

TEST(FundamentalMatrix, DegenerateSamplesHaveNoSolution) {
  Correspondences c = correspondences_of(make_scene({.seed = 2}));
  std::array<Matrix3, 3> found;
  EXPECT_EQ(fundamental_from_seven(c, {0, 0, 0, 0, 0, 0, 0}, found), 0);
  EXPECT_FALSE(fundamental_from_many(c, std::vector<std::uint32_t>{0, 1, 2, 3, 4, 5, 6}).has_value());
  EXPECT_FALSE(fundamental_from_many(c, std::vector<std::uint32_t>(9, 3)).has_value());
}

TEST(FundamentalMatrix, LeastSquaresFindsTheTruth) {
  for (std::uint64_t seed = 0; seed < 10; ++seed) {
    const TwoViewScene scene =
        make_scene({.seed = seed, .points = 60, .outliers = 0, .noise_px = 0.05, .scale_b = seed % 2 == 0 ? 1.0 : 1.5});
    const Correspondences c = correspondences_of(scene);
    std::vector<std::uint32_t> all(c.size());
    std::iota(all.begin(), all.end(), 0u);
    const auto f = fundamental_from_many(c, all);
    ASSERT_TRUE(f.has_value());
    EXPECT_NEAR(determinant(*f), 0, 1e-12);
    const auto in_px = in_pixels({.kind = GeometryKind::kFundamental, .matrix = *f, .inliers = {}}, scene.a, scene.b);
    for (const auto& [i, j] : scene.true_matches) {
      EXPECT_LT(test::epipolar_distance_px(in_px, scene.a.appearances[i], scene.b.appearances[j]), 0.8);
      EXPECT_LT(test::epipolar_distance_px(scene.fundamental, scene.a.appearances[i], scene.b.appearances[j]), 0.8);
    }
  }
}

TEST(FundamentalMatrix, DistanceIsTheLargerOfBothImages) {
  const TwoViewScene scene = make_scene({.seed = 3, .points = 40, .outliers = 40});
  const Correspondences c = correspondences_of(scene);
  const RobustFundamental robust = robust_fundamental(c, 1, {});
  ASSERT_TRUE(robust.found);
  std::vector<float> d2;
  epipolar_distances2(c, robust.f, d2);
  for (std::size_t i = 0; i < c.size(); ++i) {
    const auto line_distance = [&](bool forward) {
      const double x = forward ? c.xa[i] : c.xb[i];
      const double y = forward ? c.ya[i] : c.yb[i];
      double l[3];
      for (int r = 0; r < 3; ++r) {
        l[r] = forward ? robust.f[3 * r] * x + robust.f[3 * r + 1] * y + robust.f[3 * r + 2]
                       : robust.f[r] * x + robust.f[3 + r] * y + robust.f[6 + r];
      }
      const double u = forward ? c.xb[i] : c.xa[i];
      const double v = forward ? c.yb[i] : c.ya[i];
      return std::fabs(l[0] * u + l[1] * v + l[2]) / std::hypot(l[0], l[1]);
    };
    const double expected = std::max(line_distance(true), line_distance(false));
    EXPECT_NEAR(std::sqrt(d2[i]), expected, 1e-4 + 1e-3 * expected);
  }
}

TEST(RobustFundamental, FindsNoFewerInliersThanOpenCv) {
  double ours = 0;
  double theirs = 0;
  for (std::uint64_t seed = 0; seed < 30; ++seed) {
    const TwoViewScene scene =
        make_scene({.seed = seed, .points = 60, .outliers = static_cast<int>(2 * seed), .noise_px = 0.4});
    const Correspondences c = correspondences_of(scene);
    const RobustFundamental robust = robust_fundamental(c, seed, {.max_samples = 1000});
    ours += static_cast<double>(robust.inliers.size());
    EXPECT_TRUE(std::ranges::is_sorted(robust.inliers));
    std::vector<cv::Point2d> pa, pb;
    for (std::size_t i = 0; i < c.size(); ++i) {
      pa.emplace_back(400 * c.xa[i], 400 * c.ya[i]);
      pb.emplace_back(400 * c.xb[i], 400 * c.yb[i]);
    }
    cv::Mat f = cv::findFundamentalMat(pa, pb, cv::USAC_ACCURATE, 2.0, 0.999, 1000);
    if (f.empty()) continue;
    // Counted alike: in our coordinates, by our distance.
    Matrix3 m;
    for (int r = 0; r < 3; ++r) {
      for (int k = 0; k < 3; ++k) m[3 * r + k] = f.at<double>(r, k) * (r < 2 ? 400 : 1) * (k < 2 ? 400 : 1);
    }
    std::vector<float> d2;
    epipolar_distances2(c, m, d2);
    theirs += static_cast<double>(std::ranges::count_if(d2, [](float d) { return d <= 0.005f * 0.005f; }));
  }
  EXPECT_GT(ours, 0.98 * theirs);
}

TEST(RobustFundamental, IsRepeatableAndNeedsEight) {
  const Correspondences c = correspondences_of(make_scene({.seed = 4, .outliers = 60}));
  const RobustFundamental one = robust_fundamental(c, 7, {});
  const RobustFundamental two = robust_fundamental(c, 7, {});
  EXPECT_EQ(one.f, two.f);
  EXPECT_EQ(one.inliers, two.inliers);
  EXPECT_FALSE(robust_fundamental(select(c, {0, 1, 2, 3, 4, 5, 6}), 7, {}).found);
  EXPECT_FALSE(robust_fundamental({}, 7, {}).found);
}

TEST(Homography, LeastSquaresFindsTheTruth) {
  for (std::uint64_t seed = 0; seed < 10; ++seed) {
    const TwoViewScene scene = make_scene({.seed = seed, .points = 40, .outliers = 0, .noise_px = 0.05, .flat = true});
    const Correspondences c = correspondences_of(scene);
    std::vector<std::uint32_t> all(c.size());
    std::iota(all.begin(), all.end(), 0u);
    const auto h = homography_from_many(c, all);
    ASSERT_TRUE(h.has_value());
    const auto in_px = in_pixels({.kind = GeometryKind::kHomography, .matrix = *h, .inliers = {}}, scene.a, scene.b);
    EXPECT_LT(distance_up_to_scale(in_px.data(), scene.homography.data()), 1e-2);
    for (const auto& [i, j] : scene.true_matches) {
      EXPECT_LT(test::transfer_distance_px(in_px, scene.a.appearances[i], scene.b.appearances[j]), 0.5);
    }
  }
}

TEST(Homography, DegenerateSetsHaveNone) {
  Correspondences line;
  for (int i = 0; i < 10; ++i) {
    const float t = 0.03f * static_cast<float>(i);
    for (auto* column : {&line.xa, &line.ya, &line.xb, &line.yb}) column->push_back(t);
  }
  std::vector<std::uint32_t> all(10);
  std::iota(all.begin(), all.end(), 0u);
  EXPECT_FALSE(homography_from_many(line, all).has_value());
  EXPECT_FALSE(affine_from_many(line, all).has_value());
  EXPECT_FALSE(homography_from_many(line, std::vector<std::uint32_t>(5, 2)).has_value());
  EXPECT_FALSE(robust_homography({}, 0.01f).found);
}

TEST(Homography, RobustEstimateFindsThePlaneAmongOutliers) {
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    const TwoViewScene scene =
        make_scene({.seed = seed, .points = 40, .outliers = 60, .flat = true, .forward_m = 0.8, .roll_deg = 10.0});
    const Correspondences c = correspondences_of(scene);
    const RobustHomography robust = robust_homography(c, 0.01f);
    ASSERT_TRUE(robust.found) << seed;
    EXPECT_GE(robust.inliers.size(), 38u) << seed;
    const auto in_px =
        in_pixels({.kind = GeometryKind::kHomography, .matrix = robust.h, .inliers = {}}, scene.a, scene.b);
    for (const auto& [i, j] : scene.true_matches) {
      EXPECT_LT(test::transfer_distance_px(in_px, scene.a.appearances[i], scene.b.appearances[j]), 3) << seed;
    }
  }
}

TEST(Homography, PointsBehindTheCameraAreInfinitelyFar) {
  Correspondences c;
  for (const float x : {0.1f, 0.4f}) {
    c.xa.push_back(x);
    c.ya.push_back(0);
    c.xb.push_back(x / (1 - 4 * x));
    c.yb.push_back(0);
  }
  std::vector<float> d2;
  transfer_distances2(c, {1, 0, 0, 0, 1, 0, -4, 0, 1}, d2);
  EXPECT_LT(d2[0], 1e-10f);
  EXPECT_EQ(d2[1], INFINITY) << "its third coordinate is negative: the two points lie on a line, not in view";
}

TEST(Homography, InverseUndoes) {
  const TwoViewScene scene = make_scene({.seed = 5, .flat = true});
  const Matrix3 back = inverse(inverse(scene.homography));
  EXPECT_LT(distance_up_to_scale(back.data(), scene.homography.data()), 1e-9);
}

// Moisan & Stival's equation by the gamma function, for every k.
double log10_false_alarms_by_gamma(int n, int k, int sample, double solutions, double alpha) {
  const auto choose = [](int m, int r) { return (std::lgamma(m + 1) - std::lgamma(r + 1) - std::lgamma(m - r + 1)); };
  return (std::log(solutions * (n - sample)) + choose(n, k) + choose(k, sample) + (k - sample) * std::log(alpha)) /
         std::log(10);
}

TEST(FalseAlarms, TakeTheMostMeaningfulThreshold) {
  std::mt19937_64 random(6);
  const auto uniform = [&] { return static_cast<double>(random() >> 11) * 0x1p-53; };
  for (int trial = 0; trial < 50; ++trial) {
    const int n = 8 + static_cast<int>(random() % 80);
    std::vector<float> d2;
    for (int i = 0; i < n; ++i) {
      const double d = (i < n / 2 ? 0.01 : 0.5) * uniform();
      d2.push_back(static_cast<float>(d * d));
    }
    std::ranges::sort(d2);
    std::vector<float> background_d2;
    for (int i = 0; i < 2000; ++i) background_d2.push_back(static_cast<float>(std::pow(0.5 * uniform(), 2)));
    const Background background(background_d2, 1);
    const ModelClass model{.sample = 7, .solutions = 3, .dimension = 1};
    double lowest = INFINITY;
    int inliers = 0;
    for (int k = 8; k <= n && std::sqrt(d2[k - 1]) <= 0.02; ++k) {
      const double alpha = background.share_within(std::max(0.001, std::sqrt(static_cast<double>(d2[k - 1]))));
      const double nfa = log10_false_alarms_by_gamma(n, k, 7, 3, alpha);
      if (nfa < lowest) {
        lowest = nfa;
        inliers = k;
      }
    }
    const Significance s = significance(d2, model, background, 0.02);
    EXPECT_EQ(s.inliers, inliers);
    if (inliers > 0) {
      EXPECT_NEAR(s.log10_false_alarms, lowest, 1e-9);
    } else {
      EXPECT_EQ(s.log10_false_alarms, INFINITY);
    }
  }
}

TEST(FalseAlarms, BackgroundSharesAreCountedAndNeverBelowTheEvenSpread) {
  std::vector<float> d2;
  for (int i = 1; i <= 1000; ++i) d2.push_back(static_cast<float>(std::pow(i * 0.001, 2)));
  const Background line(d2, 1);
  EXPECT_NEAR(line.share_within(0.0205), 0.0205, 0.001);
  EXPECT_NEAR(line.share_within(0.03), 0.03, 0.0015);
  const Background point(d2, 2);  // more near the prediction than an even spread would have: counted
  EXPECT_NEAR(point.share_within(0.0105), 0.010, 0.0011);
  const Background none(std::vector<float>(100, 1.0f), 2);
  EXPECT_NEAR(none.share_within(0.03), 1.0 / 101, 1e-9);
  EXPECT_NEAR(none.share_within(0.003), 1.0 / 10100, 1e-9);
}

TEST(FalseAlarms, ShufflingExchangesSecondEndsOnly) {
  const Correspondences c = correspondences_of(make_scene({.seed = 7, .points = 10, .outliers = 0}));
  const Correspondences s = shuffled(c, 4);
  ASSERT_EQ(s.size(), 40u);
  for (std::size_t i = 0; i < s.size(); ++i) {
    EXPECT_EQ(s.xa[i], c.xa[i % 10]);
    EXPECT_EQ(s.ya[i], c.ya[i % 10]);
    const std::size_t partner = (i % 10 + i / 10 + 1) % 10;
    EXPECT_EQ(s.xb[i], c.xb[partner]);
    EXPECT_EQ(s.yb[i], c.yb[partner]);
  }
  EXPECT_EQ(shuffled(c, 100).size(), 90u) << "no match is its own background";
  EXPECT_EQ(shuffled({}, 4).size(), 0u);
}

}  // namespace
}  // namespace mapweld
