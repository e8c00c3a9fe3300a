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
  cell /= PassModel::kSupport;
  f.rivals = static_cast<std::uint8_t>(cell % PassModel::kRivals);
  f.votes = static_cast<std::uint8_t>(cell / PassModel::kRivals);
  return f;
}

TEST(PassModel, NumbersEachCombinationOfBinsOnce) {
  for (int c = 0; c < PassModel::kCells; ++c) EXPECT_EQ(PassModel::cell(features_of(c)), c);
}

TEST(PassModel, BeforeAnyVerdictPrefersVotesFewRivalsAndSupport) {
  const PassModel model(std::vector<PassModel::Count>(PassModel::kCells));
  const auto chance = [&](PassFeatures f) { return model.chance(PassModel::cell(f)); };
  for (std::uint8_t v = 1; v < PassModel::kVotes; ++v)
    EXPECT_GT(chance({v, 1, 0, 0}), chance({std::uint8_t(v - 1), 1, 0, 0}));
  EXPECT_GT(chance({4, 3, 0, 0}), chance({4, 0, 0, 0}));
  EXPECT_GT(chance({4, 1, 5, 0}), chance({4, 1, 0, 0}));
  EXPECT_LT(chance({4, 1, 2, 0}), chance({4, 1, 0, 0}));
  for (int c = 0; c < PassModel::kCells; ++c) {
    EXPECT_GT(model.chance(static_cast<std::uint16_t>(c)), 0);
    EXPECT_LT(model.chance(static_cast<std::uint16_t>(c)), 1);
  }
}

TEST(PassModel, LearnsAnAdditiveTruthAlsoWhereItSawLittle) {
  // A truth that contradicts the prior: votes are worth nothing, rivals are a good sign.
  const auto truth = [](const PassFeatures& f) {
    return 1 / (1 + std::exp(-(-1.0 + 0.8 * (3 - f.rivals) + 0.4 * f.support - 0.5 * f.history)));
  };
  std::mt19937 random(1);
  std::vector<PassModel::Count> counts(PassModel::kCells);
  for (int i = 0; i < 20000; ++i) {
    const int cell = static_cast<int>(random() % PassModel::kCells);
    if (cell % 5 == 0) continue;  // never seen
    ++counts[cell].verified;
    if (static_cast<double>(random()) / 4294967296.0 < truth(features_of(cell))) ++counts[cell].passed;
  }
  const PassModel model(counts);
  double worst = 0;
  for (int c = 0; c < PassModel::kCells; c += 5) {
    worst = std::max(worst, std::abs(model.chance(static_cast<std::uint16_t>(c)) - truth(features_of(c))));
  }
  EXPECT_LT(worst, 0.08);
}

TEST(PassModel, ACellThatTheModelDoesNotFitFindsItsOwnShare) {
  std::vector<PassModel::Count> counts(PassModel::kCells);
  for (int c = 0; c < PassModel::kCells; ++c) counts[c] = {40, 4};
  counts[100] = {4000, 3600};
  const PassModel model(counts);
  EXPECT_NEAR(model.chance(100), 0.9, 0.01);
  EXPECT_NEAR(model.chance(900), 0.1, 0.05);
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
  CandidateEvidence evidence(rows, columns, cells);
  std::vector<int> verdicts(cells.size(), -1);
  for (int round = 0; round < 150; ++round) {
    const auto i = static_cast<std::uint32_t>(random() % cells.size());
    if (verdicts[i] >= 0) continue;
    verdicts[i] = random() % 2 == 0 ? 1 : 0;
    evidence.note(i, verdicts[i] == 1);
  }
  std::uint32_t verified = 0;
  for (const PassModel::Count& c : evidence.counts()) verified += c.verified;
  EXPECT_EQ(verified, cells.size() - static_cast<std::size_t>(std::ranges::count(verdicts, -1)));
  for (std::uint32_t i = 0; i < cells.size(); ++i) {
    EXPECT_EQ(evidence.find(cells[i].row, cells[i].column), i);
    int near[2] = {0, 0}, lines[2] = {0, 0};
    std::uint32_t best = 0, fewer = 0;
    for (std::uint32_t k = 0; k < cells.size(); ++k) {
      const bool same_row = cells[k].row == cells[i].row, same_column = cells[k].column == cells[i].column;
      if (same_row || same_column) best = std::max(best, cells[k].votes);
      if (cells[k].votes < cells[i].votes) ++fewer;
      if (k == i || verdicts[k] < 0) continue;
      const int dr = static_cast<int>(cells[k].row) - static_cast<int>(cells[i].row);
      const int dc = static_cast<int>(cells[k].column) - static_cast<int>(cells[i].column);
      if (std::abs(dr) <= 2 && std::abs(dc) <= 2) ++near[verdicts[k]];
      if (same_row || same_column) ++lines[verdicts[k]];
    }
    const PassFeatures f = evidence.features(i);
    EXPECT_EQ(f.votes, 8 * fewer / cells.size());
    EXPECT_EQ(f.rivals == 3, cells[i].votes == best);
    EXPECT_EQ(f.support == 0, near[0] == 0 && near[1] == 0);
    EXPECT_EQ(f.support == 1 || f.support == 2, near[1] == 0 && near[0] > 0);
    EXPECT_EQ(f.support >= 5, near[1] > near[0]);
    EXPECT_EQ(f.history == 0, lines[0] == 0 && lines[1] == 0);
    EXPECT_EQ(f.history >= 3, lines[1] > 0);
  }
  EXPECT_EQ(evidence.find(0, columns), evidence.size());
}

}  // namespace
}  // namespace mapweld
