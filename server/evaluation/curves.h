// How the quality of a merge grew: algebraic connectivity on a vertex set that does not change, after any number of
// the edges that a run inserted.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "core/graph/appearance_graph.h"
#include "core/merge/merge_input.h"
#include "server/evaluation/recorded_run.h"

namespace mapweld::server::evaluation {

// The largest component of the finished graph: members' inner edges and every edge that a whole merge finds. On this
// fixed vertex set lambda_2 only grows as edges arrive (Fiedler 1973), from 0 while the component is still in pieces to
// the final value, which is one and the same for all methods. Immutable: any number of threads may ask.
class FinalComponent {
 public:
  FinalComponent(const MergeInput& input, std::span<const RecordedEdge> finished);

  std::uint32_t vertices() const { return static_cast<std::uint32_t>(vertices_.size()); }
  std::uint32_t components() const { return components_; }  // of the finished graph
  double final_connectivity() const { return final_connectivity_; }
  const AppearanceGraph& inner() const { return inner_; }  // induced on the component, inner edges only
  std::uint32_t merged_vertices() const { return static_cast<std::uint32_t>(place_.size()); }

  // lambda_2 of the graph induced on the component, with the inner edges and `edges`.
  double connectivity(std::span<const RecordedEdge> edges) const;
  // The least number of edges, from the first on, with which the component is in one piece; nullopt: all do not do it.
  std::optional<std::uint64_t> edges_to_connect(std::span<const RecordedEdge> edges) const;
  // The ends of an edge as vertices of inner(); none for an edge outside of the component.
  std::optional<std::pair<VertexId, VertexId>> places_of(const RecordedEdge& edge) const;

 private:
  AppearanceGraph graph_with(std::span<const RecordedEdge> edges) const;

  static constexpr std::uint32_t kOutside = 0xFFFFFFFF;
  std::vector<std::uint32_t> place_;  // of a merged vertex in the component
  std::vector<VertexId> vertices_;    // ascending
  AppearanceGraph inner_;
  std::uint32_t components_ = 0;
  double final_connectivity_ = 0;
};

// After so many edges of a run.
struct CurvePoint {
  std::uint64_t edges = 0;
  double connectivity = 0;              // lambda_2 on the final component
  std::uint32_t joined_vertices = 0;    // of all members: those with an inter edge
  std::uint32_t independent_joins = 0;  // maximum matching of the inter edges
};

// The curve of one run, computed where it is asked for and remembered. `component` and `run` must outlive it.
class RunCurve {
 public:
  RunCurve(const FinalComponent& component, const RecordedRun& run);

  const CurvePoint& at(std::uint64_t edges);
  // The least number of edges whose lambda_2 is `level` (0..1) of the final value or more, found by bisection, as
  // lambda_2 is monotone; nullopt when the run ended below. `level` is met up to 1e-9, the eigenvalue's rounding.
  std::optional<std::uint64_t> edges_to(double level);
  // Points enough to draw it: 0, all, some `wanted` in a geometric row and as many evenly spaced from where the
  // component is in one piece; and whatever was asked for before. Ascending.
  std::vector<CurvePoint> points(std::uint32_t wanted);

 private:
  const FinalComponent& component_;
  const RecordedRun& run_;
  std::optional<std::uint64_t> connected_;
  std::map<std::uint64_t, CurvePoint> known_;
};

// How many edges the run had inserted when it had spent `budget` along the axis, those at exactly `budget` included.
std::uint64_t edges_within(const RecordedRun& run, CostAxis axis, double modelled_verifier_s, double budget);

// What the run had spent when it had `edges` edges; nothing for none.
Cost cost_of(const RecordedRun& run, std::uint64_t edges);

}  // namespace mapweld::server::evaluation
