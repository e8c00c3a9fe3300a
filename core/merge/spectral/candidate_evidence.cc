#include "core/merge/spectral/candidate_evidence.h"

#include <algorithm>
#include <utility>

namespace mapweld {
namespace {

// Where one candidate in so many has a verdict, reading those in their order costs as much as passing by all.
constexpr std::uint32_t kFarApart = 16;

}  // namespace

CandidateEvidence::CandidateEvidence(std::uint32_t rows, std::uint32_t columns, std::vector<Cell> cells,
                                     std::vector<float> odds)
    : cells_(std::move(cells)),
      row_offsets_(rows + 1, 0),
      odds_(std::move(odds)),
      verdicts_(cells_.size(), Verdict::kNone),
      near_(cells_.size()),
      of_row_(rows),
      of_column_(columns) {
  for (const Cell& c : cells_) ++row_offsets_[c.row + 1];
  for (std::uint32_t r = 0; r < rows; ++r) row_offsets_[r + 1] += row_offsets_[r];
}

std::uint32_t CandidateEvidence::first_at(std::uint32_t row, std::uint32_t column) const {
  const auto begin = cells_.begin() + row_offsets_[row], end = cells_.begin() + row_offsets_[row + 1];
  return static_cast<std::uint32_t>(std::ranges::lower_bound(begin, end, column, {}, &Cell::column) - cells_.begin());
}

std::uint32_t CandidateEvidence::find(std::uint32_t row, std::uint32_t column) const {
  const std::uint32_t found = first_at(row, column);
  return found < row_offsets_[row + 1] && cells_[found].column == column ? found : size();
}

void CandidateEvidence::note(std::uint32_t candidate, bool passed) {
  const Cell c = cells_[candidate];
  verdicts_[candidate] = passed ? Verdict::kPassed : Verdict::kFailed;
  verified_.push_back(candidate);
  of_row_[c.row].note(passed);
  of_column_[c.column].note(passed);
  const std::uint32_t first_row = c.row < kWindow ? 0 : c.row - kWindow;
  const std::uint32_t first_column = c.column < kWindow ? 0 : c.column - kWindow;
  const auto end_row = std::min<std::uint32_t>(c.row + kWindow + 1, static_cast<std::uint32_t>(of_row_.size()));
  for (std::uint32_t r = first_row; r < end_row; ++r) {
    for (std::uint32_t i = first_at(r, first_column); i < row_offsets_[r + 1]; ++i) {
      if (cells_[i].column > c.column + kWindow) break;
      if (i != candidate) near_[i].note(passed);
    }
  }
}

std::vector<PassModel::Count> CandidateEvidence::counts() const {
  std::vector<PassModel::Count> counts(PassModel::kCells);
  const auto add = [&](std::uint32_t i) {
    const PassFeatures f = features(i);
    PassModel::Count& count = counts[PassModel::cell(f)];
    ++count.verified;
    count.passed += verdicts_[i] == Verdict::kPassed ? 1 : 0;
    count.odds += f.odds;
  };
  if (verified_.size() < size() / kFarApart) {
    for (const std::uint32_t i : verified_) add(i);
  } else {
    for (std::uint32_t i = 0; i < size(); ++i) {
      if (!is_open(i)) add(i);
    }
  }
  return counts;
}

}  // namespace mapweld
