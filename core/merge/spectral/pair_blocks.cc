#include "core/merge/spectral/pair_blocks.h"

#include "core/merge/spectral/candidate_evidence.h"

namespace mapweld {

PairBlocks::PairBlocks(const std::vector<MergeMember>& members) {
  for (const MemberPair& pair : all_member_pairs(members)) {
    if (!first_row.empty()) sources.resize(sources.size() + CandidateEvidence::kWindow);
    const std::vector<VertexId>&rows = members[pair.m2].vertices, &columns = members[pair.m1].vertices;
    first_row.push_back(static_cast<std::uint32_t>(sources.size()));
    first_column.push_back(static_cast<std::uint32_t>(targets.size()));
    sources.insert(sources.end(), rows.begin(), rows.end());
    targets.insert(targets.end(), columns.begin(), columns.end());
  }
}

}  // namespace mapweld
