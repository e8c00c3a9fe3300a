// The candidates of all pairs of members as the cells of one matrix.
#pragma once

#include <cstdint>
#include <vector>

#include "core/merge/merge_input.h"

namespace mapweld {

// The S of each pair (m2's images as rows, m1's as columns) stands on the diagonal of one matrix, in the order of
// all_member_pairs. Between two of them are so many empty rows that what is near in the matrix is near in both
// members' sequences.
struct PairBlocks {
  explicit PairBlocks(const std::vector<MergeMember>& members);

  std::vector<std::uint32_t> first_row, first_column;  // by pair
  std::vector<VertexId> sources, targets;              // by row, by column; of an empty row: vertex 0
};

}  // namespace mapweld
