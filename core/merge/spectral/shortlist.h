// The open candidates with the best scores when an epoch begins.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/merge/spectral/candidate_evidence.h"
#include "core/merge/spectral/connectivity_gain.h"
#include "core/merge/spectral/pass_model.h"

namespace mapweld {

// What joining two components is worth, the best strengthening edge being worth 1: weight, and size times the square
// root of the smaller one's share of all vertices.
struct JoinWorth {
  double weight = 2;
  double size = 4;
  std::uint32_t vertices = 0;
  double of(std::uint32_t smaller) const { return weight + size * std::sqrt(static_cast<double>(smaller) / vertices); }
};

// What an edge within a component that is not the largest is worth: less than any strengthening of the largest.
inline constexpr double kWorthElsewhere = 0.01;

// What the scores of an epoch go by (SpectralOrder). `sources`, `targets`: the vertex of each row, of each column.
struct ScoreBasis {
  const CandidateEvidence& evidence;
  const PassModel& model;
  const ConnectivityGain& gain;  // as it was when the graph was embedded
  std::span<const VertexId> sources, targets;
  JoinWorth join;
};

// The `count` open candidates with the best scores (ties: lower numbers), ascending by number; all when there are no
// more. Scores them roughly first, four bytes a candidate, and exactly only where that leaves doubt.
std::vector<std::uint32_t> draw_shortlist(const ScoreBasis& basis, std::size_t count);

}  // namespace mapweld
