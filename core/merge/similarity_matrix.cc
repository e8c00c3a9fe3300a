#include "core/merge/similarity_matrix.h"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "core/errors.h"

namespace mapweld {
namespace {

constexpr std::uint32_t kMostVotes = 65535;

// Adds to one cell; true when this took it to `min_votes`.
inline bool vote(std::uint16_t& cell, std::uint32_t votes, std::uint32_t min_votes) {
  const std::uint32_t before = cell;
  const std::uint32_t after = std::min(before + votes, kMostVotes);
  cell = static_cast<std::uint16_t>(after);
  return before < min_votes && after >= min_votes;
}

}  // namespace

SimilarityMatrix SimilarityMatrix::dense(std::uint32_t rows, std::uint32_t columns) {
  SimilarityMatrix result;
  result.rows_ = rows;
  result.columns_ = columns;
  result.votes_.assign(static_cast<std::size_t>(rows) * columns, 0);
  return result;
}

SimilarityMatrix SimilarityMatrix::sparse(std::uint32_t rows, std::uint32_t columns) {
  SimilarityMatrix result;
  result.is_sparse_ = true;
  result.rows_ = rows;
  result.columns_ = columns;
  result.offsets_.assign(1, 0);
  return result;
}

SimilarityMatrix SimilarityMatrix::restore(bool is_sparse, std::uint32_t rows, std::uint32_t columns,
                                           std::vector<std::uint64_t> offsets, std::vector<std::uint32_t> kept_columns,
                                           std::vector<std::uint16_t> votes) {
  const auto refuse = [](bool wrong) {
    if (wrong) throw FormatError("the parts of a similarity matrix do not fit together");
  };
  if (is_sparse) {
    refuse(offsets.empty() || offsets.size() > static_cast<std::size_t>(rows) + 1 || offsets.front() != 0);
    refuse(offsets.back() != kept_columns.size() || votes.size() != kept_columns.size());
    refuse(!std::ranges::is_sorted(offsets));
    for (std::size_t row = 0; row + 1 < offsets.size(); ++row) {
      for (std::uint64_t k = offsets[row]; k < offsets[row + 1]; ++k) {
        refuse(kept_columns[k] >= columns || (k > offsets[row] && kept_columns[k] <= kept_columns[k - 1]));
      }
    }
  } else {
    refuse(!offsets.empty() || !kept_columns.empty() || votes.size() != static_cast<std::size_t>(rows) * columns);
  }
  SimilarityMatrix result;
  result.is_sparse_ = is_sparse;
  result.rows_ = rows;
  result.columns_ = columns;
  result.offsets_ = std::move(offsets);
  result.kept_columns_ = std::move(kept_columns);
  result.votes_ = std::move(votes);
  return result;
}

void SimilarityMatrix::append_row(std::span<const std::uint32_t> columns) {
  if (!is_sparse_ || appended_rows() >= rows_) throw std::logic_error("the similarity matrix has all its rows");
  kept_columns_.insert(kept_columns_.end(), columns.begin(), columns.end());
  votes_.resize(kept_columns_.size(), 0);
  offsets_.push_back(kept_columns_.size());
}

void SimilarityMatrix::append_row(std::span<const std::uint32_t> columns, std::span<const std::uint32_t> votes) {
  if (columns.size() != votes.size()) throw std::logic_error("a row's columns and votes are not equally many");
  append_row(columns);
  const std::size_t first = votes_.size() - votes.size();
  for (std::size_t k = 0; k < votes.size(); ++k) {
    votes_[first + k] = static_cast<std::uint16_t>(std::min(votes[k], kMostVotes));
  }
}

void SimilarityMatrix::add(std::uint32_t row, std::span<const VotedVertex> columns, std::uint32_t min_votes,
                           std::vector<Cell>& reached) {
  if (!is_sparse_) {
    std::uint16_t* const cells = votes_.data() + static_cast<std::size_t>(row) * columns_;
    for (const VotedVertex& c : columns) {
      const std::uint32_t column = to_index(c.vertex);
      if (vote(cells[column], c.votes, min_votes)) reached.push_back({row, column, cells[column]});
    }
    return;
  }
  auto kept = kept_columns_.begin() + static_cast<std::ptrdiff_t>(offsets_[row]);
  const auto end = kept_columns_.begin() + static_cast<std::ptrdiff_t>(offsets_[row + 1]);
  for (const VotedVertex& c : columns) {
    const std::uint32_t column = to_index(c.vertex);
    kept = std::lower_bound(kept, end, column);
    if (kept == end) return;
    std::uint16_t& cell = votes_[static_cast<std::size_t>(kept - kept_columns_.begin())];
    if (*kept == column && vote(cell, c.votes, min_votes)) reached.push_back({row, column, cell});
  }
}

std::uint32_t SimilarityMatrix::at(std::uint32_t row, std::uint32_t column) const {
  if (!is_sparse_) return votes_[static_cast<std::size_t>(row) * columns_ + column];
  const auto begin = kept_columns_.begin() + static_cast<std::ptrdiff_t>(offsets_[row]);
  const auto end = kept_columns_.begin() + static_cast<std::ptrdiff_t>(offsets_[row + 1]);
  const auto found = std::lower_bound(begin, end, column);
  return found != end && *found == column ? votes_[static_cast<std::size_t>(found - kept_columns_.begin())] : 0;
}

bool operator==(const SimilarityMatrix& a, const SimilarityMatrix& b) {
  return a.is_sparse_ == b.is_sparse_ && a.rows_ == b.rows_ && a.columns_ == b.columns_ && a.offsets_ == b.offsets_ &&
         a.kept_columns_ == b.kept_columns_ && a.votes_ == b.votes_;
}

}  // namespace mapweld
