#include "core/merge/spectral/pair_blocks.h"

#include <gtest/gtest.h>

#include "core/merge/spectral/candidate_evidence.h"

namespace mapweld {
namespace {

// A and B of four images each, C of two: A x B, A x C, B x C.
const std::vector<MergeMember> kMembers = number_members({4, 4, 2});

TEST(PairBlocks, EveryImageHasItsRowAndColumnInEachOfItsPairs) {
  const PairBlocks blocks(kMembers);
  const std::vector<MemberPair> pairs = all_member_pairs(kMembers);
  ASSERT_EQ(blocks.first_row.size(), pairs.size());
  for (std::size_t p = 0; p < pairs.size(); ++p) {
    const std::vector<VertexId>&rows = kMembers[pairs[p].m2].vertices, &columns = kMembers[pairs[p].m1].vertices;
    for (std::size_t i = 0; i < rows.size(); ++i) EXPECT_EQ(blocks.sources[blocks.first_row[p] + i], rows[i]);
    for (std::size_t i = 0; i < columns.size(); ++i) EXPECT_EQ(blocks.targets[blocks.first_column[p] + i], columns[i]);
    if (p > 0) {
      EXPECT_GE(blocks.first_row[p], blocks.first_row[p - 1] + kMembers[pairs[p - 1].m2].vertices.size());
      EXPECT_GE(blocks.first_column[p], blocks.first_column[p - 1] + kMembers[pairs[p - 1].m1].vertices.size());
    }
  }
}

TEST(PairBlocks, NoVerdictSupportsACandidateOfAnotherPair) {
  const PairBlocks blocks(kMembers);
  std::vector<CandidateEvidence::Cell> cells;
  const std::vector<MemberPair> pairs = all_member_pairs(kMembers);
  std::vector<std::size_t> pair_of;
  for (std::size_t p = 0; p < pairs.size(); ++p) {
    for (std::uint32_t r = 0; r < kMembers[pairs[p].m2].vertices.size(); ++r) {
      for (std::uint32_t c = 0; c < kMembers[pairs[p].m1].vertices.size(); ++c) {
        cells.push_back({blocks.first_row[p] + r, blocks.first_column[p] + c, 9});
        pair_of.push_back(p);
      }
    }
  }
  for (std::uint32_t verified = 0; verified < cells.size(); ++verified) {
    CandidateEvidence evidence(static_cast<std::uint32_t>(blocks.sources.size()),
                               static_cast<std::uint32_t>(blocks.targets.size()), cells,
                               std::vector<float>(cells.size(), 0));
    evidence.note(verified, true);
    bool has_supported = false;
    for (std::uint32_t other = 0; other < cells.size(); ++other) {
      if (other == verified) continue;
      if (pair_of[other] == pair_of[verified]) {
        has_supported |= evidence.features(other).support != 0;
        continue;
      }
      EXPECT_EQ(evidence.features(other).support, 0) << verified << ", " << other;
      EXPECT_EQ(evidence.features(other).history, 0) << verified << ", " << other;
    }
    EXPECT_TRUE(has_supported) << verified;
  }
}

}  // namespace
}  // namespace mapweld
