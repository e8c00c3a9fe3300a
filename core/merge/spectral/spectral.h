// Our own method: all votes first, then verification in the order of SpectralOrder.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include "core/merge/methods/pair_merger.h"
#include "core/merge/spectral/pair_blocks.h"
#include "core/merge/spectral/spectral_order.h"
#include "core/merge/spectral/vote_odds.h"

namespace mapweld {

// Phase kVoting: a step takes up the votes of one image of m2, pair of members after pair, in the order of
// all_member_pairs; its candidates (final votes at least min_votes) come to `postponed`, ascending by (pair, row,
// column). Phase kVerification: a step chooses the next batch, which is then `pending`, or verifies one candidate of
// it: one order over all pairs. `postponed` stands still meanwhile: which of them are left follows from the verdicts,
// as does everything else that the order goes by. Of very many candidates the order is made in several steps that leave
// the state as it is. Candidates whose verdict is known from before the maps grew are left out: their edges are in the
// graph. docs/spectral.md has the reasons and the figures.
class Spectral final : public PairMerger {
 public:
  static constexpr std::string_view kName = "spectral";
  explicit Spectral(MergeInput input) : Spectral(std::move(input), SpectralOptions{}) {}
  Spectral(MergeInput input, const SpectralOptions& options);

  void step() override;
  std::vector<bool> finished_pairs() const override;

 private:
  void resume(MergeState state) override;
  void upcoming(std::size_t most, std::vector<Candidate>& candidates) const override;
  std::vector<Candidate> candidates_left() const override;
  void keep_row();
  void choose_batch();
  void take_pending();
  void advance();
  bool next_votes();
  bool make_order(std::size_t candidates);
  void restore_order();
  std::uint64_t inherited() const { return state_.inherited_edges + state_.inherited_rejected; }
  std::size_t pair_of(VertexId u, VertexId v) const;
  bool is_source(VertexId vertex, std::size_t pair) const { return member_of(vertex) == pairs()[pair].m2; }
  CandidateEvidence::Cell cell_of(const Candidate& candidate) const;
  std::uint32_t find(VertexId source, VertexId target) const;  // its number in the order; size() when it has none

  SpectralOptions options_;
  PairBlocks blocks_;
  struct Making {
    AppearanceGraph inner;
    std::vector<CandidateEvidence::Cell> cells;
    std::optional<VoteOdds> odds;
  };
  std::unique_ptr<Making> making_;        // of the order
  std::optional<SpectralOrder> order_;    // for the first batch and ever after; follows from the state
  std::vector<std::uint64_t> open_;       // by pair: of `postponed`, those without a verdict
  std::vector<std::uint32_t> row_votes_;  // scratch
};

}  // namespace mapweld
