// Brute-force merging (paper, section V): m1 is kept, the vertices of m2 are localized in it one by one.
#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

#include "core/merge/methods/pair_merger.h"

namespace mapweld {

// The images of m2 in their order; all candidates of an image (final votes at least min_votes) by votes descending,
// then target. A step takes up the votes of one image, or verifies one candidate. One phase: kVerification.
class BruteForce final : public PairMerger {
 public:
  static constexpr std::string_view kName = "brute-force";
  explicit BruteForce(MergeInput input);
  void step() override;
  // Votes are counted image by image: they are all in with the last image of the last pair of members.
  std::optional<std::vector<Candidate>> open_candidates() const override;

 private:
  std::vector<Candidate> candidates_left() const override;
  void upcoming(std::size_t most, std::vector<Candidate>& candidates) const override;
  void vote();
  void advance();
  std::vector<std::uint32_t> row_votes_;  // scratch
};

}  // namespace mapweld
