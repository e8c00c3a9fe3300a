#include "core/merge/certificate/pass_rate.h"

#include <bit>

namespace mapweld {

PassRate::PassRate(const MergeState& state) {
  const auto note = [this](std::uint32_t votes, double passed) {
    for (Count* count : {&classes_[static_cast<std::size_t>(class_of(votes))], &all_}) {
      count->verified += 1;
      count->passed += passed;
    }
  };
  for (const MergeEdge& e : state.edges) note(e.votes, 1);
  for (const RejectedPair& r : state.rejected) note(r.votes, 0);
}

int PassRate::class_of(std::uint32_t votes) {
  if (votes < 2) return static_cast<int>(votes);
  const int octave = std::bit_width(votes) - 1;
  return 2 * octave + static_cast<int>(votes >> (octave - 1) & 1);
}

double PassRate::chance(std::uint32_t votes) const {
  const double overall = (all_.passed + 1) / (all_.verified + 2);
  const Count& own = classes_[static_cast<std::size_t>(class_of(votes))];
  return (own.passed + kLeaning * overall) / (own.verified + kLeaning);
}

}  // namespace mapweld
