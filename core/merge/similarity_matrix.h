// The similarity matrix S (paper, section V): S_ij counts the votes that image i of m2 and image j of m1 received so
// far.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/retrieval/voting.h"

namespace mapweld {

// Cells hold 16 bits and saturate at 65535. A value; compares by what it holds.
//
// Two layouts with one behaviour:
// - dense: every cell, rows x columns x 2 bytes, row-major.
// - sparse: only the cells whose final votes are known to reach min_votes, found row by row beforehand; no other cell
// can
//   ever become a candidate, so none is kept. 20,000 x 20,000 images take a few megabytes instead of 800.
class SimilarityMatrix {
 public:
  struct Cell {
    std::uint32_t row = 0;
    std::uint32_t column = 0;
    std::uint32_t votes = 0;
    friend auto operator<=>(const Cell&, const Cell&) = default;
  };

  SimilarityMatrix() = default;
  static SimilarityMatrix dense(std::uint32_t rows, std::uint32_t columns);
  static SimilarityMatrix sparse(std::uint32_t rows, std::uint32_t columns);
  // From what the accessors below gave. Throws FormatError when the parts do not fit together.
  static SimilarityMatrix restore(bool is_sparse, std::uint32_t rows, std::uint32_t columns,
                                  std::vector<std::uint64_t> offsets, std::vector<std::uint32_t> kept_columns,
                                  std::vector<std::uint16_t> votes);

  // Sparse: keeps these columns (ascending) of the next row, with no votes yet. Rows are added in order, each once.
  void append_row(std::span<const std::uint32_t> columns);
  // The same with all their votes already; past 65535 they count as 65535.
  void append_row(std::span<const std::uint32_t> columns, std::span<const std::uint32_t> votes);

  // Adds the votes that one word gives a row and some columns (ascending). Appends to `reached` the cells whose votes
  // reach `min_votes` with this word, with their votes now, in order of columns.
  void add(std::uint32_t row, std::span<const VotedVertex> columns, std::uint32_t min_votes,
           std::vector<Cell>& reached);

  // Votes so far; 0 for a cell that is not kept.
  std::uint32_t at(std::uint32_t row, std::uint32_t column) const;

  std::uint32_t rows() const { return rows_; }
  std::uint32_t columns() const { return columns_; }
  bool is_sparse() const { return is_sparse_; }
  std::uint32_t appended_rows() const { return static_cast<std::uint32_t>(offsets_.empty() ? 0 : offsets_.size() - 1); }
  std::span<const std::uint64_t> offsets() const { return offsets_; }            // sparse: rows so far + 1
  std::span<const std::uint32_t> kept_columns() const { return kept_columns_; }  // sparse
  std::span<const std::uint16_t> votes() const { return votes_; }                // dense: rows x columns; sparse: kept
  friend bool operator==(const SimilarityMatrix& a, const SimilarityMatrix& b);

 private:
  bool is_sparse_ = false;
  std::uint32_t rows_ = 0;
  std::uint32_t columns_ = 0;
  std::vector<std::uint64_t> offsets_;
  std::vector<std::uint32_t> kept_columns_;
  std::vector<std::uint16_t> votes_;
};

}  // namespace mapweld
