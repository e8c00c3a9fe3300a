// What there is to be had: the order of one who knows beforehand which candidates pass, and what no order surpasses.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "server/evaluation/curves.h"
#include "server/evaluation/recorded_run.h"

namespace mapweld::server::evaluation {

// Of one level of the final value.
struct LevelLimit {
  double level = 0;
  std::optional<CurvePoint> clairvoyant;  // where the clairvoyant reaches it; none: not within its limit of picks
  std::uint64_t least_edges = 0;          // by the bound: nobody reaches it with fewer
};

// How many times the clairvoyant's edges these verifications are; none where the clairvoyant needs none or never gets
// there.
std::optional<double> to_clairvoyant(const LevelLimit& limit, double verifications);

struct BoundPoint {
  std::uint64_t edges = 0;
  double connectivity = 0;  // no choice of so many of the final edges has more on the final component
};

struct Limit {
  std::vector<CurvePoint> clairvoyant;  // ascending by edges, as RunCurve::points; it stops at the highest level
  std::vector<LevelLimit> levels;       // as given
  std::vector<BoundPoint> bound;        // ascending, from one edge to all; empty when there are none
};

struct LimitOptions {
  std::vector<double> levels;       // shares of the final value, ascending
  std::uint32_t curve_points = 24;  // see RunCurve::points
  std::uint32_t bound_points = 16;  // in a geometric row; more lie where a level's bound is sought
  int threads = 1;
};

// Of the edges that count in the end; those outside of the final component are of no use. `progress` is told how many
// of how many pieces of work are done, from any thread, one at a time.
Limit limit_of(const FinalComponent& component, std::span<const RecordedEdge> edges, const LimitOptions& options,
               const std::function<void(std::uint64_t done, std::uint64_t total)>& progress = {});

}  // namespace mapweld::server::evaluation
