// Local alignments of two image sequences in a sparse matrix of scores: Smith & Waterman (1981) as Ho & Newman (2005)
// modified it, with several disjoint alignments in the manner of Waterman & Eggert (1987).
#pragma once

#include <cstdint>
#include <optional>
#include <queue>
#include <span>
#include <vector>

namespace mapweld {

struct SequenceAlignmentOptions {
  std::uint32_t max_step = 4;       // two successive pairs are at most so many images apart, in either sequence; >= 1
  std::int32_t skip_penalty = 4;    // for each image of either sequence that is passed over between two pairs
  std::int32_t repeat_penalty = 4;  // for a pair that has an image in common with the pair before it
  std::int64_t min_score = 24;      // an alignment's least score; >= 1
  std::uint32_t max_pairs = 1000;   // of a longer alignment only the last so many pairs are told; >= 1
};

// A pair of images and how well they match. Pairs that are not listed do not match.
struct ScoredPair {
  std::uint32_t row = 0;
  std::uint32_t column = 0;
  std::int32_t score = 0;  // > 0
  friend bool operator==(const ScoredPair&, const ScoredPair&) = default;
};

struct SequenceAlignment {
  // The sum of its pairs' scores less the penalties between them.
  std::int64_t score = 0;
  bool is_reversed = false;  // the columns run backwards: travelled in opposite directions
  // In order of travel along the rows: rows never fall; columns never fall, or never rise when it is reversed.
  std::vector<ScoredPair> pairs;
  friend bool operator==(const SequenceAlignment&, const SequenceAlignment&) = default;
};

// The alignments of a matrix, best first. Scores are integers, so that nothing depends on rounding. Not thread-safe.
//
// H of a pair is the score of the best alignment that ends with it,
//   H(i, j) = score(i, j) + max(0, max H(i - a, j - b) - skip_penalty * (max(a - 1, 0) + max(b - 1, 0))
//                                                    - repeat_penalty * (1 if a = 0 or b = 0)),
// over the listed pairs with 0 <= a, b <= max_step, not both 0; reversed: H(i - a, j + b). As in Ho & Newman every move
// gathers the score of the pair that it comes to, sideways moves too, because the two robots need not be equally fast.
// A pair that matches nothing costs what passing over its images costs. Ties: fewest images back (a + b), then least a.
// Of alignments with equal scores comes first the one in the same direction, then the one whose last pair has the
// lowest row, then the lowest column.
class SequenceAligner {
 public:
  // `pairs` in order of (row, column), each once.
  SequenceAligner(std::uint32_t rows, std::vector<ScoredPair> pairs, const SequenceAlignmentOptions& options);

  // Computes H of up to so many more pairs in one direction; true when all is computed. Cost: some max_step^2 look-ups
  // for each, less where the matrix is sparse.
  bool prepare(std::uint64_t pairs);

  // The best alignment with min_score or more; none is left: nullopt. Requires that prepare() has said true.
  std::optional<SequenceAlignment> best();

  struct Position {
    std::uint32_t row = 0;
    std::uint32_t column = 0;
  };
  // Takes pairs out of the matrix; those that are not in it are ignored. H is brought up to date where it changes,
  // which is in the surroundings of the pairs.
  void remove(std::span<const Position> positions);

 private:
  static constexpr std::uint32_t kNone = 0xFFFFFFFF;
  struct Direction {
    std::vector<std::int64_t> h;       // by pair; 0: removed
    std::vector<std::uint32_t> from;   // the pair before, or kNone
    std::vector<std::uint8_t> queued;  // scratch of `remove`, all zero between calls
  };
  struct End {
    std::int64_t score;
    bool is_reversed;
    std::uint32_t pair;
    // Of two ends the one that is taken later; std::priority_queue keeps the greatest on top.
    bool operator<(const End& other) const {
      if (score != other.score) return score < other.score;
      if (is_reversed != other.is_reversed) return is_reversed;
      return pair > other.pair;
    }
  };

  // A pair's place in the order in which H is computed, and back (the mapping is its own inverse): rows ascending,
  // columns in the direction of travel.
  std::uint32_t turn(std::uint32_t pair, bool is_reversed) const;
  // Calls visit(pair, a, b) for the listed pairs that are a rows and b columns before (after) `pair`.
  template <typename Visit>
  void visit_window(std::uint32_t pair, bool is_reversed, bool is_after, Visit&& visit) const;
  bool compute(std::uint32_t pair, bool is_reversed);  // true: H has changed
  void update(bool is_reversed, std::span<const std::uint32_t> removed);
  std::uint32_t find(Position position) const;

  SequenceAlignmentOptions options_;
  std::vector<ScoredPair> pairs_;
  std::vector<std::uint32_t> offsets_;  // of each row in pairs_
  std::vector<bool> is_removed_;
  Direction directions_[2];  // same, reversed
  std::uint64_t computed_ = 0;
  std::priority_queue<End> ends_;  // entries that no longer agree with H are skipped
};

// 0 .. n - 1 so that every beginning of it is spread over the whole: both ends, the middle, the quarters, ...
std::vector<std::uint32_t> spread_order(std::uint32_t n);

}  // namespace mapweld
