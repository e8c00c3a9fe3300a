// What the methods that merge one pair of members share: the vote source, and what becomes of a verdict.
#pragma once

#include <cstdint>
#include <vector>

#include "core/merge/merger.h"
#include "core/merge/vote_source.h"

namespace mapweld {

class PairMerger : public Merger {
 protected:
  // `input.votes` is set.
  explicit PairMerger(MergeInput input);
  void resume(MergeState state) override;

  const VoteSource& votes() const { return *input_.votes; }
  VertexId source(std::uint32_t row) const { return m2_->vertices[row]; }
  VertexId target(std::uint32_t column) const { return m1_->vertices[column]; }
  std::uint32_t row(VertexId source) const { return position_[to_index(source)]; }
  std::uint32_t column(VertexId target) const { return position_[to_index(target)]; }

  // Verifies a candidate and records the verdict: an edge with its final votes, or a rejection. True: an edge.
  bool verify(const Candidate& candidate);

 private:
  const MergeMember* m1_;
  const MergeMember* m2_;
  std::vector<std::uint32_t> position_;  // of each merged vertex in its member
  std::vector<bool> in_m2_;              // by merged vertex
};

}  // namespace mapweld
