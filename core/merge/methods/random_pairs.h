// Randomised brute force (paper, section VI): pairs of images drawn uniformly, each once.
#pragma once

#include <string_view>
#include <vector>

#include "core/merge/methods/pair_merger.h"
#include "core/merge/methods/random_order.h"

namespace mapweld {

// The paper's: an attempt draws one of all pairs of an image of m2 and an image of m1 that have not been drawn yet. A
// pair with too few votes costs a look-up in S, any other its verification. First all votes are counted (kVoting, a
// step an image of m2); then a step goes on to the next candidate, but over no more than kLookUpsPerStep pairs.
class RandomPairs final : public PairMerger {
 public:
  static constexpr std::string_view kName = "random";
  static constexpr std::uint64_t kLookUpsPerStep = 4096;
  explicit RandomPairs(MergeInput input);
  void step() override;

 private:
  void resume(MergeState state) override;
  std::vector<Candidate> candidates_left() const override { return cells_left(); }
  void upcoming(std::size_t most, std::vector<Candidate>& candidates) const override;
  // The next candidate at or after attempt `from`, of at most kLookUpsPerStep; `from` is moved past it.
  bool find_candidate(std::uint64_t& from, Candidate& candidate) const;
  void begin_pair();
  void advance();
  RandomOrder order_{0, 0};
};

// The fairer opponent: draws among the candidates only, each once. An attempt is a verification.
class RandomCandidates final : public PairMerger {
 public:
  static constexpr std::string_view kName = "random-candidates";
  explicit RandomCandidates(MergeInput input);
  void step() override;

 private:
  void resume(MergeState state) override;
  std::vector<Candidate> candidates_left() const override { return cells_left(); }
  void upcoming(std::size_t most, std::vector<Candidate>& candidates) const override;
  Candidate drawn(std::uint64_t attempt) const;
  void begin_pair();
  void begin_drawing();
  void advance();
  RandomOrder order_{0, 0};
};

}  // namespace mapweld
