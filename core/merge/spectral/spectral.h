// Our own method: all votes first, then verification in the order of SpectralOrder.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include "core/merge/methods/pair_merger.h"
#include "core/merge/spectral/spectral_order.h"

namespace mapweld {

// Phase kVoting: a step takes up the votes of one image of m2; its candidates (final votes at least min_votes) come to
// `postponed`, ascending by (row, column). Phase kVerification: a step chooses the next batch, which is then `pending`,
// or verifies one candidate of it. `postponed` stands still meanwhile: which of them are left follows from the
// verdicts, as does everything else that the order goes by. Candidates whose verdict is known from before the maps grew
// are left out: their edges are in the graph. Several pairs of members are gone through one after the other.
// docs/spectral.md has the reasons and the figures.
class Spectral final : public PairMerger {
 public:
  static constexpr std::string_view kName = "spectral";
  explicit Spectral(MergeInput input) : Spectral(std::move(input), SpectralOptions{}) {}
  Spectral(MergeInput input, const SpectralOptions& options);

  void step() override;

 private:
  void resume(MergeState state) override;
  void upcoming(std::size_t most, std::vector<Candidate>& candidates) const override;
  std::vector<Candidate> candidates_left() const override;
  void begin_pair();
  void keep_row();
  void choose_batch();
  void take_pending();
  void advance();
  void make_order();
  void restore_order();

  SpectralOptions options_;
  std::optional<SpectralOrder> order_;    // of the pair of members in hand; follows from the state
  std::uint64_t verified_before_ = 0;     // verifications of the merge when this pair's began
  std::vector<std::uint32_t> row_votes_;  // scratch
};

}  // namespace mapweld
