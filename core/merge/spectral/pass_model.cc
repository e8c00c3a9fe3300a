#include "core/merge/spectral/pass_model.h"

#include <algorithm>
#include <stdexcept>

namespace mapweld {
namespace {

constexpr int kWeights = 1 + PassModel::kOdds + PassModel::kSupport + PassModel::kHistory;
constexpr int kSweeps = 8;
constexpr double kRidge = 1.0;     // a prior weight counts like so much information
constexpr double kCellPrior = 30;  // verdicts that a cell needs to outweigh the model

// Prior weights: the odds are taken as they are, passed neighbours are good signs.
constexpr std::array<double, kWeights> kPrior{0.0,                                        // constant
                                              0.0, 0.0,  0.0,  0.0,  0.0, 0.0, 0.0, 0.0,  // odds
                                              0.0, 0.0,  0.0,  0.0,  0.0, 0.0, 0.0, 0.0,
                                              0.0, -0.6, -1.4, -0.2, 0.8, 1.6, 2.4,  // support
                                              0.0, -0.3, -0.8, -0.4, 0.2, 0.5};      // history

std::array<int, 3> weights_of(int cell) {
  const int history = cell % PassModel::kHistory;
  cell /= PassModel::kHistory;
  const int support = cell % PassModel::kSupport, odds = cell / PassModel::kSupport;
  const int first_support = 1 + PassModel::kOdds;
  return {1 + odds, first_support + support, first_support + PassModel::kSupport + history};
}

}  // namespace

PassModel::PassModel(const std::vector<Count>& counts) {
  if (counts.size() != kCells) throw std::invalid_argument("a pass model needs the counts of every cell");
  struct Data {
    std::array<int, 3> weights;
    double verified, passed, sum;
  };
  std::array<double, kWeights> weight = kPrior;
  const auto sum_of = [&weight](const std::array<int, 3>& w) {
    return weight[0] + weight[w[0]] + weight[w[1]] + weight[w[2]];
  };
  std::vector<Data> data;
  std::array<std::vector<std::uint32_t>, kWeights> users;
  for (int c = 0; c < kCells; ++c) {
    if (counts[c].verified == 0) continue;
    const std::array<int, 3> w = weights_of(c);
    for (const int k : w) users[k].push_back(static_cast<std::uint32_t>(data.size()));
    users[0].push_back(static_cast<std::uint32_t>(data.size()));
    data.push_back({w, static_cast<double>(counts[c].verified), static_cast<double>(counts[c].passed),
                    sum_of(w) + counts[c].odds / counts[c].verified});
  }
  for (int sweep = 0; sweep < kSweeps; ++sweep) {
    for (int k = 0; k < kWeights; ++k) {
      if (users[k].empty()) continue;
      double slope = kRidge * (kPrior[k] - weight[k]), curvature = kRidge;
      for (const std::uint32_t d : users[k]) {
        const double p = logistic(data[d].sum);
        slope += data[d].passed - data[d].verified * p;
        curvature += data[d].verified * p * (1 - p);
      }
      const double change = std::clamp(slope / curvature, -1.0, 1.0);
      weight[k] += change;
      for (const std::uint32_t d : users[k]) data[d].sum += change;
    }
  }
  for (int c = 0; c < kCells; ++c) {
    const double offset = sum_of(weights_of(c)), verified = counts[c].verified;
    offsets_[c] = static_cast<float>(offset);
    if (counts[c].verified == 0) continue;
    const double odds = counts[c].odds / verified;
    const double chance = (counts[c].passed + kCellPrior * logistic(odds + offset)) / (verified + kCellPrior);
    offsets_[c] = static_cast<float>(mapweld::log_odds(chance) - odds);
  }
}

}  // namespace mapweld
