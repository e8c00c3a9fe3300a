#include "core/merge/spectral/pass_model.h"

#include <algorithm>
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "core/merge/spectral/candidate_evidence.h"

namespace mapweld {
namespace {

PassFeatures features_of(int cell) {
  PassFeatures f;
  f.history = static_cast<std::uint8_t>(cell % PassModel::kHistory);
  cell /= PassModel::kHistory;
  f.support = static_cast<std::uint8_t>(cell % PassModel::kSupport);
  f.odds = -6 + 0.75f * static_cast<float>(cell / PassModel::kSupport) + 0.375f;
  return f;
}

TEST(PassModel, NumbersEachCombinationOfBinsOnce) {
  for (int c = 0; c < PassModel::kCells; ++c) EXPECT_EQ(PassModel::cell(features_of(c)), c);
}

std::vector<PassModel::Count> no_verdicts() { return std::vector<PassModel::Count>(PassModel::kCells); }

void count(PassModel::Count& cell, float odds, std::uint32_t verified, std::uint32_t passed) {
  cell = {verified, passed, double{odds} * verified};
}

TEST(PassModel, BeforeAnyVerdictTakesTheOddsAsTheyAre) {
  const PassModel model(no_verdicts());
  for (const float odds : {-7.5f, -2.0f, -0.1f, 0.0f, 1.25f, 8.0f}) {
    EXPECT_NEAR(model.chance({odds, 0, 0}), 1 / (1 + std::exp(-odds)), 0.01) << odds;
  }
  EXPECT_GT(model.chance({0, 5, 0}), model.chance({0, 0, 0}));
  EXPECT_LT(model.chance({0, 2, 0}), model.chance({0, 0, 0}));
}

TEST(PassModel, OddsBeyondTheLastBinStillTellCandidatesApart) {
  std::vector<PassModel::Count> counts = no_verdicts();
  count(counts[PassModel::cell({-9, 0, 0})], -9, 500, 2);
  const PassModel model(counts);
  EXPECT_LT(model.chance({-9, 0, 0}), model.chance({-8, 0, 0}));
  EXPECT_LT(model.chance({8, 0, 0}), model.chance({9, 0, 0}));
}

TEST(PassModel, LearnsAnAdditiveTruthAlsoWhereItSawLittle) {
  // A truth that contradicts the prior: the odds are a bad sign.
  const auto truth = [](const PassFeatures& f) {
    return 1 / (1 + std::exp(-(-1.0 - 0.3 * double{f.odds} + 0.4 * f.support - 0.5 * f.history)));
  };
  std::mt19937 random(1);
  std::vector<PassModel::Count> counts = no_verdicts();
  for (int i = 0; i < 20000; ++i) {
    const int cell = static_cast<int>(random() % PassModel::kCells);
    if (cell % 5 == 0) continue;  // never seen
    const PassFeatures f = features_of(cell);
    ++counts[cell].verified;
    counts[cell].odds += double{f.odds};
    if (static_cast<double>(random()) / 4294967296.0 < truth(f)) ++counts[cell].passed;
  }
  const PassModel model(counts);
  double worst = 0;
  for (int c = 0; c < PassModel::kCells; c += 5) {
    worst = std::max(worst, std::abs(model.chance(features_of(c)) - truth(features_of(c))));
  }
  EXPECT_LT(worst, 0.08);
}

TEST(PassModel, ACellThatTheModelDoesNotFitFindsItsOwnShare) {
  std::vector<PassModel::Count> counts = no_verdicts();
  for (int c = 0; c < PassModel::kCells; ++c) count(counts[c], features_of(c).odds, 40, 4);
  count(counts[100], features_of(100).odds, 4000, 3600);
  const PassModel model(counts);
  EXPECT_NEAR(model.chance(features_of(100)), 0.9, 0.01);
  EXPECT_NEAR(model.chance(features_of(500)), 0.1, 0.05);
}

// Counted again from nothing.
TEST(CandidateEvidence, CountsWhatHappenedNearBy) {
  std::mt19937 random(2);
  const std::uint32_t rows = 20, columns = 30;
  std::vector<CandidateEvidence::Cell> cells;
  for (std::uint32_t r = 0; r < rows; ++r) {
    for (std::uint32_t c = 0; c < columns; ++c) {
      if (random() % 3 == 0) cells.push_back({r, c, 10 + static_cast<std::uint32_t>(random() % 30)});
    }
  }
  std::vector<float> odds;
  for (std::size_t i = 0; i < cells.size(); ++i) odds.push_back(0.125f * static_cast<float>(i));
  CandidateEvidence evidence(rows, columns, cells, odds);
  std::vector<int> verdicts(cells.size(), -1);
  for (int round = 0; round < 150; ++round) {
    const auto i = static_cast<std::uint32_t>(random() % cells.size());
    if (verdicts[i] >= 0) continue;
    verdicts[i] = random() % 2 == 0 ? 1 : 0;
    evidence.note(i, verdicts[i] == 1);
  }
  std::uint32_t verified = 0;
  double sum = 0;
  for (const PassModel::Count& c : evidence.counts()) {
    verified += c.verified;
    sum += c.odds;
  }
  EXPECT_EQ(verified, cells.size() - static_cast<std::size_t>(std::ranges::count(verdicts, -1)));
  for (std::uint32_t i = 0; i < cells.size(); ++i) {
    if (verdicts[i] >= 0) sum -= double{odds[i]};
    EXPECT_EQ(evidence.find(cells[i].row, cells[i].column), i);
    int near[2] = {0, 0}, lines[2] = {0, 0};
    for (std::uint32_t k = 0; k < cells.size(); ++k) {
      const bool same_row = cells[k].row == cells[i].row, same_column = cells[k].column == cells[i].column;
      if (k == i || verdicts[k] < 0) continue;
      const int dr = static_cast<int>(cells[k].row) - static_cast<int>(cells[i].row);
      const int dc = static_cast<int>(cells[k].column) - static_cast<int>(cells[i].column);
      if (std::abs(dr) <= 2 && std::abs(dc) <= 2) ++near[verdicts[k]];
      if (same_row || same_column) ++lines[verdicts[k]];
    }
    const PassFeatures f = evidence.features(i);
    EXPECT_EQ(f.odds, odds[i]);
    EXPECT_EQ(f.support == 0, near[0] == 0 && near[1] == 0);
    EXPECT_EQ(f.support == 1 || f.support == 2, near[1] == 0 && near[0] > 0);
    EXPECT_EQ(f.support >= 5, near[1] > near[0]);
    EXPECT_EQ(f.history == 0, lines[0] == 0 && lines[1] == 0);
    EXPECT_EQ(f.history >= 3, lines[1] > 0);
  }
  EXPECT_EQ(sum, 0);
  EXPECT_EQ(evidence.find(0, columns), evidence.size());
}

}  // namespace
}  // namespace mapweld
