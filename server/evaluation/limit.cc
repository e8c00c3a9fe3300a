#include "server/evaluation/limit.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <mutex>
#include <utility>

#include "core/merge/limit/choice_bound.h"
#include "core/merge/limit/clairvoyant.h"
#include "server/evaluation/parallel.h"

namespace mapweld::server::evaluation {
namespace {

constexpr double kRounding = 1e-9;   // of lambda_2, relatively
constexpr double kOvershoot = 1e-7;  // of the clairvoyant's goal: its own values are rougher than the curve's

using Ends = std::vector<std::pair<VertexId, VertexId>>;

std::vector<std::uint32_t> geometric_row(std::uint32_t most, std::uint32_t points) {
  std::vector<std::uint32_t> row;
  if (most == 0) return row;
  for (std::uint32_t i = 0; i < points; ++i) {
    const double share = points > 1 ? static_cast<double>(i) / (points - 1) : 1;
    row.push_back(static_cast<std::uint32_t>(std::lround(std::pow(most, share))));
  }
  row.erase(std::unique(row.begin(), row.end()), row.end());
  return row;
}

// The bound by number of edges, wherever it has been asked for.
class Bound {
 public:
  // `good`: the clairvoyant's picks.
  Bound(const AppearanceGraph& inner, const Ends& ends, std::vector<std::uint32_t> good)
      : inner_(inner), ends_(ends), good_(std::move(good)) {}

  double at(std::uint32_t count) {
    {
      const std::lock_guard lock(mutex_);
      if (const auto found = known_.find(count); found != known_.end()) return found->second;
    }
    const double bound = choice_bound(inner_, ends_, count, {.good = good_});
    const std::lock_guard lock(mutex_);
    return known_.emplace(count, bound).first->second;
  }

  // The least number whose bound is `goal` or more, between neighbours of `row`.
  std::uint32_t least(double goal, const std::vector<std::uint32_t>& row) {
    std::uint32_t low = 0, high = static_cast<std::uint32_t>(ends_.size());
    for (const std::uint32_t count : row) {
      if (at(count) >= goal) {
        high = count;
        break;
      }
      low = count + 1;
    }
    while (low < high) {
      const std::uint32_t middle = low + (high - low) / 2;
      if (at(middle) >= goal) {
        high = middle;
      } else {
        low = middle + 1;
      }
    }
    return low;
  }

  // Whatever bounds more edges bounds fewer.
  std::vector<BoundPoint> points() const {
    std::vector<BoundPoint> points;
    for (const auto& [count, bound] : known_) points.push_back({count, bound});
    for (std::size_t i = points.size(); i-- > 1;) {
      points[i - 1].connectivity = std::min(points[i - 1].connectivity, points[i].connectivity);
    }
    return points;
  }

 private:
  const AppearanceGraph& inner_;
  const Ends& ends_;
  std::vector<std::uint32_t> good_;
  std::mutex mutex_;
  std::map<std::uint32_t, double> known_;
};

}  // namespace

std::optional<double> to_clairvoyant(const LevelLimit& limit, double verifications) {
  if (!limit.clairvoyant || limit.clairvoyant->edges == 0) return std::nullopt;
  return verifications / static_cast<double>(limit.clairvoyant->edges);
}

Limit limit_of(const FinalComponent& component, std::span<const RecordedEdge> edges, const LimitOptions& options,
               const std::function<void(std::uint64_t, std::uint64_t)>& progress) {
  const double whole = component.final_connectivity();
  std::vector<RecordedEdge> inside;
  Ends ends;
  for (const RecordedEdge& edge : edges) {
    const auto places = component.places_of(edge);
    if (!places) continue;
    inside.push_back(edge);
    ends.push_back(*places);
  }
  const std::vector<std::uint32_t> row =
      whole > 0 ? geometric_row(static_cast<std::uint32_t>(ends.size()), options.bound_points)
                : std::vector<std::uint32_t>{};
  const std::uint64_t total = 1 + row.size() + options.levels.size();
  std::mutex mutex;
  std::uint64_t done = 0;
  const auto tell = [&] {
    const std::lock_guard lock(mutex);
    if (progress) progress(++done, total);
  };

  Limit limit;
  RecordedRun run;
  std::vector<std::uint32_t> picked;
  std::vector<double> goals;
  for (const double level : options.levels) goals.push_back(level * whole * (1 - kRounding));
  if (whole > 0 && !goals.empty()) {
    for (const ClairvoyantPick& pick :
         clairvoyant_order(component.inner(), ends, {.goal = goals.back() * (1 + kOvershoot)})) {
      picked.push_back(pick.edge);
      run.edges.push_back(inside[pick.edge]);
      run.edges.back().cost = {.verifications = run.edges.size(), .elapsed_s = 0, .verifier_s = 0};
    }
  }
  tell();
  RunCurve curve(component, run);
  for (const double level : options.levels) {
    LevelLimit& of_level = limit.levels.emplace_back();
    of_level.level = level;
    if (const auto reached = curve.edges_to(level)) of_level.clairvoyant = curve.at(*reached);
  }
  limit.clairvoyant = curve.points(options.curve_points);

  Bound bound(component.inner(), ends, std::move(picked));
  parallel_for(row.size(), options.threads, [&](std::size_t i) {
    bound.at(row[i]);
    tell();
  });
  parallel_for(limit.levels.size(), options.threads, [&](std::size_t l) {
    if (whole > 0) limit.levels[l].least_edges = bound.least(goals[l], row);
    tell();
  });
  limit.bound = bound.points();
  return limit;
}

}  // namespace mapweld::server::evaluation
