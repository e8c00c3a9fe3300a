// The chance that a candidate passes verification, learnt from the verdicts so far.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

namespace mapweld {

// What is known of a candidate, each as a small number (a bin).
struct PassFeatures {
  std::uint8_t votes = 0;    // eighth of all candidates by votes: 7 has the most
  std::uint8_t rivals = 0;   // its votes beside the best of its row and of its column: 3 is the best of both
  std::uint8_t support = 0;  // verdicts near by along both sequences
  std::uint8_t history = 0;  // verdicts of its source and of its target
};

// An additive logistic model over the bins (a weight for each bin of each feature), fitted to all verdicts at once by
// Newton steps on one weight after the other and held near fixed prior weights; then each combination of bins (a
// cell) moves from the model's chance to its own share of passed verdicts as it gathers some. Only counts go in, so
// that the model does not depend on the order of the verdicts; only + - * / are used, so that it is the same
// everywhere.
class PassModel {
 public:
  static constexpr int kVotes = 8, kRivals = 4, kSupport = 7, kHistory = 6;
  static constexpr int kCells = kVotes * kRivals * kSupport * kHistory;

  static std::uint16_t cell(const PassFeatures& f) {
    return static_cast<std::uint16_t>(((f.votes * kRivals + f.rivals) * kSupport + f.support) * kHistory + f.history);
  }

  // Verdicts by cell.
  struct Count {
    std::uint32_t verified = 0;
    std::uint32_t passed = 0;
  };
  explicit PassModel(const std::vector<Count>& counts);

  double chance(std::uint16_t cell) const { return chances_[cell]; }

 private:
  std::array<float, kCells> chances_{};
};

}  // namespace mapweld
