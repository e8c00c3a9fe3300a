// How often a candidate passes verification, learnt from the verdicts of a merge so far.
#pragma once

#include <array>
#include <cstdint>

#include "core/merge/merge_state.h"

namespace mapweld {

// By votes: candidates of about as many votes (two classes an octave) pass about as often. A class with few verdicts
// leans on the rate of all. A function of the set of verdicts.
class PassRate {
 public:
  explicit PassRate(const MergeState& state);

  // Between 0 and 1, both excluded.
  double chance(std::uint32_t votes) const;

 private:
  static constexpr int kClasses = 66;
  static constexpr double kLeaning = 4;  // verdicts of all that weigh as much as those of the class
  static int class_of(std::uint32_t votes);
  struct Count {
    double verified = 0;
    double passed = 0;
  };
  std::array<Count, kClasses> classes_{};
  Count all_;
};

}  // namespace mapweld
