// What the votes and the verdicts so far tell about each candidate.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/merge/spectral/pass_model.h"

namespace mapweld {

// Candidates are cells of S, numbered in order of (row, column). Everything that verdicts change is a sum of counts, so
// that it does not depend on their order.
class CandidateEvidence {
 public:
  struct Cell {
    std::uint32_t row = 0;
    std::uint32_t column = 0;
    std::uint32_t votes = 0;
  };
  enum class Verdict : std::uint8_t { kNone, kPassed, kFailed };
  // Images so far apart along the sequence, at most, are neighbours.
  static constexpr std::uint32_t kWindow = 2;

  // `cells`: ascending by (row, column), each once. `odds`: of each, by votes alone (vote_odds).
  CandidateEvidence(std::uint32_t rows, std::uint32_t columns, std::vector<Cell> cells, std::vector<float> odds);

  std::uint32_t size() const { return static_cast<std::uint32_t>(cells_.size()); }
  const Cell& cell(std::uint32_t candidate) const { return cells_[candidate]; }
  Verdict verdict(std::uint32_t candidate) const { return verdicts_[candidate]; }
  bool is_open(std::uint32_t candidate) const { return verdicts_[candidate] == Verdict::kNone; }
  std::uint32_t open() const { return size() - static_cast<std::uint32_t>(verified_.size()); }
  std::uint32_t rows() const { return static_cast<std::uint32_t>(of_row_.size()); }
  // The candidates of a row are those from first_of(row) to first_of(row + 1) - 1.
  std::uint32_t first_of(std::uint32_t row) const { return row_offsets_[row]; }
  // The number of the candidate in a cell; size() when there is none.
  std::uint32_t find(std::uint32_t row, std::uint32_t column) const;

  // Takes note of a verdict, the only one on this candidate.
  void note(std::uint32_t candidate, bool passed);

  // As the verdicts on the other candidates have it now.
  PassFeatures features(std::uint32_t candidate) const {
    const Cell& c = cells_[candidate];
    const SmallTally near = near_[candidate];
    std::uint32_t passed = of_row_[c.row].passed + of_column_[c.column].passed;
    std::uint32_t failed = of_row_[c.row].failed + of_column_[c.column].failed;
    if (verdicts_[candidate] == Verdict::kPassed) passed -= 2;
    if (verdicts_[candidate] == Verdict::kFailed) failed -= 2;
    return {odds_[candidate], static_cast<std::uint8_t>(support_bin(near.passed, near.failed)),
            static_cast<std::uint8_t>(history_bin(passed, failed))};
  }
  // Verdicts by cell of the pass model, each with the features that its candidate has now.
  std::vector<PassModel::Count> counts() const;

 private:
  // Sums of comparisons: all candidates are looked through, and a processor guesses their branches badly.
  static int support_bin(std::uint32_t passed, std::uint32_t failed) {
    if (passed == 0) return (failed > 0 ? 1 : 0) + (failed >= 3 ? 1 : 0);
    return 3 + (2 * passed >= failed ? 1 : 0) + (passed > failed ? 1 + (passed >= 4 ? 1 : 0) : 0);
  }

  static int history_bin(std::uint32_t passed, std::uint32_t failed) {
    if (passed == 0) return (failed > 0 ? 1 : 0) + (failed > 3 ? 1 : 0);
    return 3 + (4 * passed >= failed ? 1 : 0) + (passed > failed ? 1 : 0);
  }

  std::uint32_t first_at(std::uint32_t row, std::uint32_t column) const;  // first candidate of the row from column on

  struct Tally {
    std::uint32_t passed = 0;
    std::uint32_t failed = 0;
    void note(bool has_passed) { ++(has_passed ? passed : failed); }
  };
  std::vector<Cell> cells_;
  std::vector<std::uint32_t> row_offsets_;
  std::vector<float> odds_;
  std::vector<Verdict> verdicts_;
  std::vector<std::uint32_t> verified_;  // in order of their verdicts
  struct SmallTally {
    std::uint8_t passed = 0;
    std::uint8_t failed = 0;
    void note(bool has_passed) { ++(has_passed ? passed : failed); }
  };
  static_assert((2 * kWindow + 1) * (2 * kWindow + 1) <= 0xFF);
  std::vector<SmallTally> near_;
  std::vector<Tally> of_row_, of_column_;
};

}  // namespace mapweld
