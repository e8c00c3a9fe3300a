#include "core/merge/methods/sequence_alignment.h"

#include <algorithm>
#include <functional>
#include <map>
#include <random>
#include <set>
#include <tuple>

#include <gtest/gtest.h>

namespace mapweld {
namespace {

using Cell = std::pair<std::uint32_t, std::uint32_t>;
using Scores = std::map<Cell, std::int32_t>;

struct Sequences {
  std::uint32_t rows = 0;
  std::uint32_t columns = 0;
  Scores scores;
};

std::vector<ScoredPair> pairs_of(const Scores& scores) {
  std::vector<ScoredPair> pairs;
  for (const auto& [cell, score] : scores) pairs.push_back({cell.first, cell.second, score});
  return pairs;
}

SequenceAligner aligner_of(const Sequences& s, const SequenceAlignmentOptions& options) {
  SequenceAligner aligner(s.rows, pairs_of(s.scores), options);
  while (!aligner.prepare(7)) {
  }
  return aligner;
}

void remove(SequenceAligner& aligner, const SequenceAlignment& alignment) {
  std::vector<SequenceAligner::Position> positions;
  for (const ScoredPair& pair : alignment.pairs) positions.push_back({pair.row, pair.column});
  aligner.remove(positions);
}

std::int64_t penalty(std::int64_t a, std::int64_t b, const SequenceAlignmentOptions& options) {
  const std::int64_t skipped = std::max<std::int64_t>(a - 1, 0) + std::max<std::int64_t>(b - 1, 0);
  return skipped * options.skip_penalty + (a == 0 || b == 0 ? options.repeat_penalty : 0);
}

// The whole dynamic programme from scratch, over every cell of a dense matrix and every move, whose columns are
// mirrored for the other direction; then the best end, traced back.
std::optional<SequenceAlignment> best_by_dense_programme(const Sequences& s, const SequenceAlignmentOptions& options) {
  struct Best {
    std::int64_t score = 0;
    SequenceAlignment alignment;
  } best;
  for (const bool is_reversed : {false, true}) {
    const auto score_at = [&](std::int64_t i, std::int64_t j) -> std::int64_t {
      const auto column = static_cast<std::uint32_t>(is_reversed ? s.columns - 1 - j : j);
      const auto found = s.scores.find({static_cast<std::uint32_t>(i), column});
      return found == s.scores.end() ? 0 : found->second;
    };
    std::map<std::pair<std::int64_t, std::int64_t>, std::int64_t> h;
    std::map<std::pair<std::int64_t, std::int64_t>, std::pair<std::int64_t, std::int64_t>> from;
    for (std::int64_t i = 0; i < s.rows; ++i) {
      for (std::int64_t j = 0; j < s.columns; ++j) {
        if (score_at(i, j) == 0) continue;
        std::vector<std::tuple<std::int64_t, std::int64_t, std::int64_t>> moves;  // (-value, a + b, a)
        for (std::int64_t a = 0; a <= options.max_step && a <= i; ++a) {
          for (std::int64_t b = 0; b <= options.max_step && b <= j; ++b) {
            if ((a == 0 && b == 0) || score_at(i - a, j - b) == 0) continue;
            const std::int64_t value = h[{i - a, j - b}] - penalty(a, b, options);
            if (value > 0) moves.emplace_back(-value, a + b, a);
          }
        }
        h[{i, j}] = score_at(i, j);
        if (moves.empty()) continue;
        const auto [negative, both, a] = *std::min_element(moves.begin(), moves.end());
        h[{i, j}] -= negative;
        from[{i, j}] = {i - a, j - (both - a)};
      }
    }
    // Ends by (row, column), not by mirrored column.
    std::vector<std::tuple<std::int64_t, std::int64_t, std::int64_t>> ends;
    for (const auto& [cell, value] : h) {
      ends.emplace_back(-value, cell.first, is_reversed ? s.columns - 1 - cell.second : cell.second);
    }
    if (ends.empty()) continue;
    const auto [negative, row, column] = *std::min_element(ends.begin(), ends.end());
    if (-negative < options.min_score || -negative <= best.score) continue;
    best = {-negative, {}};
    best.alignment.is_reversed = is_reversed;
    std::pair<std::int64_t, std::int64_t> at{row, is_reversed ? s.columns - 1 - column : column};
    std::int64_t rest = 0;
    for (;;) {
      const auto true_column = static_cast<std::uint32_t>(is_reversed ? s.columns - 1 - at.second : at.second);
      const auto score = static_cast<std::int32_t>(score_at(at.first, at.second));
      best.alignment.pairs.push_back({static_cast<std::uint32_t>(at.first), true_column, score});
      rest = h[at] - score;
      if (!from.contains(at) || best.alignment.pairs.size() == options.max_pairs) break;
      at = from[at];
    }
    best.alignment.score = -negative - rest;
    std::reverse(best.alignment.pairs.begin(), best.alignment.pairs.end());
  }
  if (best.score == 0) return std::nullopt;
  return best.alignment;
}

// The best score of any chain at all, by trying them all.
std::int64_t best_by_enumeration(const Sequences& s, const SequenceAlignmentOptions& options) {
  const std::vector<ScoredPair> pairs = pairs_of(s.scores);
  std::int64_t best = 0;
  for (const int direction : {1, -1}) {
    const std::function<void(const ScoredPair&, std::int64_t)> extend = [&](const ScoredPair& last, std::int64_t sum) {
      best = std::max(best, sum);
      for (const ScoredPair& next : pairs) {
        const std::int64_t a = static_cast<std::int64_t>(next.row) - last.row;
        const std::int64_t b = direction * (static_cast<std::int64_t>(next.column) - last.column);
        if (a < 0 || b < 0 || (a == 0 && b == 0) || a > options.max_step || b > options.max_step) continue;
        extend(next, sum + next.score - penalty(a, b, options));
      }
    };
    for (const ScoredPair& first : pairs) extend(first, first.score);
  }
  return best;
}

Sequences random_sequences(std::mt19937& random, std::uint32_t rows, std::uint32_t columns, int one_in) {
  Sequences s{rows, columns, {}};
  for (std::uint32_t i = 0; i < rows; ++i) {
    for (std::uint32_t j = 0; j < columns; ++j) {
      if (random() % static_cast<unsigned>(one_in) == 0) s.scores[{i, j}] = 1 + static_cast<std::int32_t>(random() % 8);
    }
  }
  return s;
}

SequenceAlignmentOptions random_options(std::mt19937& random) {
  SequenceAlignmentOptions options;
  options.max_step = 1 + random() % 4;
  options.skip_penalty = static_cast<std::int32_t>(random() % 4);
  options.repeat_penalty = static_cast<std::int32_t>(random() % 4);
  options.min_score = 1 + random() % 20;
  options.max_pairs = random() % 3 == 0 ? 1 + random() % 6 : 1000;
  return options;
}

TEST(SequenceAlignment, IsThatOfTheDenseProgrammeOneAfterTheOther) {
  std::mt19937 random(7);
  int alignments = 0, reversed = 0;
  for (int trial = 0; trial < 150; ++trial) {
    Sequences s = random_sequences(random, 1 + random() % 14, 1 + random() % 14, 2 + trial % 5);
    const SequenceAlignmentOptions options = random_options(random);
    SequenceAligner aligner = aligner_of(s, options);
    for (;;) {
      const auto expected = best_by_dense_programme(s, options);
      const auto actual = aligner.best();
      ASSERT_EQ(actual, expected) << "trial " << trial;
      if (!actual) break;
      ++alignments;
      reversed += actual->is_reversed ? 1 : 0;
      std::vector<SequenceAligner::Position> gone{{99, 99}};  // what is not there is ignored
      for (const ScoredPair& pair : actual->pairs) gone.push_back({pair.row, pair.column});
      gone.push_back({static_cast<std::uint32_t>(random() % s.rows), static_cast<std::uint32_t>(random() % s.columns)});
      aligner.remove(gone);
      for (const auto& [row, column] : gone) s.scores.erase({row, column});
    }
  }
  EXPECT_GT(alignments, 500);
  EXPECT_GT(reversed, 100);
}

TEST(SequenceAlignment, HasTheBestScoreOfAllChains) {
  std::mt19937 random(3);
  for (int trial = 0; trial < 300; ++trial) {
    const Sequences s = random_sequences(random, 1 + random() % 6, 1 + random() % 6, 3);
    SequenceAlignmentOptions options = random_options(random);
    options.max_pairs = 1000;
    options.min_score = 1;
    SequenceAligner aligner = aligner_of(s, options);
    const auto best = aligner.best();
    ASSERT_EQ(best ? best->score : 0, best_by_enumeration(s, options)) << "trial " << trial;
  }
}

TEST(SequenceAlignment, FollowsBothDirectionsOfTravel) {
  Sequences s{30, 40, {}};
  for (std::uint32_t k = 0; k < 10; ++k) s.scores[{5 + k, 8 + k}] = 6;
  for (std::uint32_t k = 0; k < 9; ++k) s.scores[{18 + k, 35 - k}] = 6;
  SequenceAligner aligner = aligner_of(s, {});
  const auto same = aligner.best();
  ASSERT_TRUE(same);
  EXPECT_FALSE(same->is_reversed);
  EXPECT_EQ(same->score, 60);
  EXPECT_EQ(same->pairs.front(), (ScoredPair{5, 8, 6}));
  EXPECT_EQ(same->pairs.back(), (ScoredPair{14, 17, 6}));
  remove(aligner, *same);
  const auto reversed = aligner.best();
  ASSERT_TRUE(reversed);
  EXPECT_TRUE(reversed->is_reversed);
  EXPECT_EQ(reversed->score, 54);
  EXPECT_EQ(reversed->pairs.front(), (ScoredPair{18, 35, 6}));
  EXPECT_EQ(reversed->pairs.back(), (ScoredPair{26, 27, 6}));
  remove(aligner, *reversed);
  EXPECT_FALSE(aligner.best());
}

TEST(SequenceAlignment, PassesOverGapsAndWaitsForTheSlowerRobot) {
  SequenceAlignmentOptions options;
  options.max_step = 3;
  options.skip_penalty = 2;
  options.repeat_penalty = 1;
  options.min_score = 39;
  Sequences s{20, 20, {}};
  for (const std::uint32_t k : {0u, 1u, 2u, 5u, 6u}) s.scores[{k, k}] = 8;  // 3 and 4 are missing in both
  s.scores[{7, 6}] = 8;                                                     // the columns' robot stands still
  SequenceAligner aligner = aligner_of(s, options);
  const auto alignment = aligner.best();
  ASSERT_TRUE(alignment);
  EXPECT_EQ(alignment->pairs.size(), 6u);
  EXPECT_EQ(alignment->score, 6 * 8 - 4 * 2 - 1);

  options.max_step = 2;  // the gap is too wide now
  SequenceAligner shorter = aligner_of(s, options);
  options.min_score = 24;
  SequenceAligner halves = aligner_of(s, options);
  EXPECT_FALSE(shorter.best());
  EXPECT_EQ(halves.best()->score, 24);
}

TEST(SequenceAlignment, RefusesWhatItCannotAlign) {
  EXPECT_THROW(SequenceAligner(3, {{1, 1, 2}, {0, 1, 2}}, {}), std::invalid_argument);
  EXPECT_THROW(SequenceAligner(3, {{1, 1, 2}, {1, 1, 2}}, {}), std::invalid_argument);
  EXPECT_THROW(SequenceAligner(3, {{3, 1, 2}}, {}), std::invalid_argument);
  EXPECT_THROW(SequenceAligner(3, {{1, 1, 0}}, {}), std::invalid_argument);
  SequenceAlignmentOptions options;
  options.max_step = 0;
  EXPECT_THROW(SequenceAligner(3, {}, options), std::invalid_argument);
}

TEST(SpreadOrder, HasEveryNumberOnceAndEndsAndMiddleFirst) {
  for (std::uint32_t n = 0; n < 70; ++n) {
    std::vector<std::uint32_t> order = spread_order(n);
    std::vector<std::uint32_t> numbers;
    for (std::uint32_t i = 0; i < n; ++i) numbers.push_back(i);
    // Of every beginning of two or more, no gap is more than twice as wide as even spacing would leave, rounded up.
    for (std::size_t k = 2; k <= order.size(); ++k) {
      std::vector<std::uint32_t> sorted(order.begin(), order.begin() + static_cast<std::ptrdiff_t>(k));
      std::sort(sorted.begin(), sorted.end());
      for (std::size_t i = 1; i < k; ++i) EXPECT_LE(sorted[i] - sorted[i - 1], 2 * (n / (k - 1) + 1)) << n << " " << k;
    }
    std::sort(order.begin(), order.end());
    EXPECT_EQ(order, numbers);
  }
  EXPECT_EQ(spread_order(9), (std::vector<std::uint32_t>{0, 8, 4, 2, 6, 1, 3, 5, 7}));
}

}  // namespace
}  // namespace mapweld
