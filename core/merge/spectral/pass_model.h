// The chance that a candidate passes verification, learnt from the verdicts so far.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#include "core/merge/logistic.h"

namespace mapweld {

// What is known of a candidate; verdicts as a small number (a bin).
struct PassFeatures {
  float odds = 0;            // log-odds by votes alone (vote_odds)
  std::uint8_t support = 0;  // verdicts near by along both sequences
  std::uint8_t history = 0;  // verdicts of its source and of its target
};

// An additive logistic model over the odds by votes and over bins (a weight for each bin of the odds and of each
// feature), fitted to all verdicts at once by Newton steps on one weight after the other and held near fixed prior
// weights; then each combination of bins (a cell) moves from the model's chance to its own share of passed verdicts as
// it gathers some. Only exact sums go in, so that the model does not depend on the order of the verdicts; only + - * /
// and the portable logarithm are used, so that it is the same everywhere.
class PassModel {
 public:
  static constexpr int kOdds = 16, kSupport = 7, kHistory = 6;
  static constexpr int kCells = kOdds * kSupport * kHistory;

  static std::uint16_t cell(const PassFeatures& f) {
    return static_cast<std::uint16_t>((odds_bin(f.odds) * kSupport + f.support) * kHistory + f.history);
  }

  // Verdicts by cell.
  struct Count {
    std::uint32_t verified = 0;
    std::uint32_t passed = 0;
    double odds = 0;  // by votes, summed
  };
  explicit PassModel(const std::vector<Count>& counts);

  double chance(const PassFeatures& features) const { return logistic(log_odds(features)); }
  float log_odds(const PassFeatures& features) const { return features.odds + offsets_[cell(features)]; }

 private:
  // Bins of the odds by votes, from -6 to 6.
  static constexpr float kLowestOdds = -6, kOddsPerBin = 0.75f;
  static int odds_bin(float odds) {
    return std::clamp(static_cast<int>((odds - kLowestOdds) / kOddsPerBin), 0, kOdds - 1);
  }
  std::array<float, kCells> offsets_{};  // from a candidate's odds by votes to its log-odds
};

}  // namespace mapweld
