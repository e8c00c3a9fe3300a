#include "core/guard/evidence_model.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

namespace mapweld {
namespace {

TEST(EvidenceModel, WhatCannotBeTestedSaysNothing) {
  EdgeSigns signs;
  signs.rare_matches = 50;
  signs.fullness_around = 0.4;
  const EvidenceParts parts = weigh(signs, {});
  EXPECT_EQ(parts.rarity, 0) << "no far image";
  EXPECT_EQ(parts.shortfall, 0) << "no inner edge";
  EXPECT_EQ(parts.fullness, 0) << "not full; and nothing against it";
  EXPECT_EQ(parts.sum(), EvidenceModel{}.prior);
  EXPECT_EQ(weigh(signs, {}, true).sum(), EvidenceModel{}.inner_prior);
}

TEST(EvidenceModel, GrowsWithRarityItsTestAndFullness) {
  double before = -100;
  for (const int rare : {0, 1, 5, 20, 80}) {
    const double now =
        weigh({.rare_matches = rare, .far_images = 100, .fullness_around = 1, .inner_fullness = 2}, {}).sum();
    EXPECT_GT(now, before);
    before = now;
  }
  before = -100;
  for (const std::uint32_t far : {0u, 3u, 30u, 300u}) {
    const double now = weigh({.rare_matches = 20, .far_images = far}, {}).sum();
    EXPECT_GT(now, before);
    before = now;
  }
  before = -100;
  for (const double around : {0.05, 0.2, 1.0, 2.0, 5.0}) {
    const double now = weigh({.fullness_around = around, .inner_fullness = 3}, {}).sum();
    EXPECT_GE(now, before);
    before = now;
  }
}

TEST(EvidenceModel, RareMatchesSayLessWhereMoreOfTheImagesRecurs) {
  double before = 100;
  for (const double common : {0.0, 0.1, 0.4, 0.9}) {
    const double now = weigh({.rare_matches = 20, .far_images = 100, .common_share = common}, {}).rarity;
    EXPECT_LT(now, before);
    EXPECT_GT(now, 0);
    before = now;
  }
}

TEST(EvidenceModel, ANearViewInsideADenseMapIsANeighbourOnTheWay) {
  const auto nearness = [](double fullness, double inner, bool is_inner) {
    return weigh({.fullness = fullness, .fullness_around = fullness, .inner_fullness = inner}, {}, is_inner).nearness;
  };
  EXPECT_GT(nearness(4, 5, true), 2);
  EXPECT_LT(nearness(0.5, 0.5, true), 0.1) << "a sparse map's fullest may join anything";
  EXPECT_EQ(nearness(2.9, 5, true), 0) << "the maps show places again more fully than that";
  EXPECT_EQ(nearness(4, 5, false), 0) << "two maps have no way in common";
}

TEST(EvidenceModel, LessThanTheMapsOwnFullnessSpeaksAgainstTheMoreTheDenserTheyAre) {
  const auto shortfall = [](double inner) {
    return weigh({.fullness_around = 0.5, .inner_fullness = inner}, {}).shortfall;
  };
  EXPECT_EQ(shortfall(0.4), 0);
  EXPECT_LT(shortfall(1), 0);
  EXPECT_LT(shortfall(4), shortfall(2));
}

TEST(EvidenceModel, ConfidencesAreTheLogisticFunctionToFourDecimals) {
  for (double x = -12; x <= 12; x += 0.013) {
    const double exact = 1 / (1 + std::exp(-x));
    EXPECT_NEAR(confidence_of(x), std::min(exact, 0.9999), 0.5001e-4) << x;
  }
  EXPECT_EQ(confidence_of(-1e9), 0);
  EXPECT_EQ(confidence_of(1e9), 0.9999) << "nothing is certain";
}

TEST(EvidenceModel, TheLeastLogOddsOfAConfidenceIsTheLeast) {
  for (const double confidence : {0.0001, 0.0005, 0.25, 0.5, 0.9, 0.9001, 0.99, 0.9999}) {
    const double x = log_odds_of(confidence);
    EXPECT_GE(confidence_of(x), confidence) << confidence;
    EXPECT_LT(confidence_of(std::nextafter(x, -100)), confidence) << confidence;
  }
  EXPECT_EQ(log_odds_of(0), -std::numeric_limits<double>::infinity());
  EXPECT_EQ(log_odds_of(1), std::numeric_limits<double>::infinity());
}

}  // namespace
}  // namespace mapweld
