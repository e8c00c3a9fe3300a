#include "server/evaluation/curves.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "core/graph/algebraic_connectivity.h"
#include "core/graph/components.h"
#include "core/graph/disjoint_sets.h"
#include "core/graph/matching.h"

namespace mapweld::server::evaluation {
namespace {

constexpr double kRounding = 1e-9;

}  // namespace

FinalComponent::FinalComponent(const MergeInput& input, std::span<const RecordedEdge> finished) {
  std::uint32_t merged_vertices = 0;
  for (const MergeMember& member : input.members) {
    merged_vertices += static_cast<std::uint32_t>(member.vertices.size());
  }
  AppearanceGraph whole(merged_vertices, input.inner_edges);
  for (const RecordedEdge& e : finished) whole.add_edge(e.u, e.v, e.inliers);
  place_.assign(merged_vertices, kOutside);
  if (merged_vertices == 0) return;
  const Components components = connected_components(whole);
  components_ = components.count();
  vertices_ = components.vertices_of(components.largest());
  for (std::uint32_t i = 0; i < vertices_.size(); ++i) place_[to_index(vertices_[i])] = i;
  inner_ = induced_subgraph(AppearanceGraph(merged_vertices, input.inner_edges), vertices_);
  final_connectivity_ = algebraic_connectivity(induced_subgraph(whole, vertices_)).value;
}

std::optional<std::pair<VertexId, VertexId>> FinalComponent::places_of(const RecordedEdge& edge) const {
  const std::uint32_t u = place_[to_index(edge.u)], v = place_[to_index(edge.v)];
  if (u == kOutside || v == kOutside) return std::nullopt;
  return std::pair(VertexId{u}, VertexId{v});
}

AppearanceGraph FinalComponent::graph_with(std::span<const RecordedEdge> edges) const {
  AppearanceGraph graph = inner_;
  for (const RecordedEdge& e : edges) {
    if (const auto places = places_of(e)) graph.add_edge(places->first, places->second, e.inliers);
  }
  return graph;
}

double FinalComponent::connectivity(std::span<const RecordedEdge> edges) const {
  return algebraic_connectivity(graph_with(edges)).value;
}

std::optional<std::uint64_t> FinalComponent::edges_to_connect(std::span<const RecordedEdge> edges) const {
  if (vertices_.empty()) return 0;
  DisjointSets sets(static_cast<std::uint32_t>(vertices_.size()));
  for (const Edge& e : inner_.edge_list()) sets.join(to_index(e.u), to_index(e.v));
  const auto is_one = [&sets, this] { return sets.size_of(0) == vertices_.size(); };
  if (is_one()) return 0;
  for (std::size_t i = 0; i < edges.size(); ++i) {
    const auto places = places_of(edges[i]);
    if (!places) continue;
    sets.join(to_index(places->first), to_index(places->second));
    if (is_one()) return i + 1;
  }
  return std::nullopt;
}

RunCurve::RunCurve(const FinalComponent& component, const RecordedRun& run)
    : component_(component), run_(run), connected_(component.edges_to_connect(run.edges)) {}

const CurvePoint& RunCurve::at(std::uint64_t edges) {
  edges = std::min<std::uint64_t>(edges, run_.edges.size());
  if (const auto found = known_.find(edges); found != known_.end()) return found->second;
  const std::span<const RecordedEdge> taken(run_.edges.data(), edges);
  CurvePoint point;
  point.edges = edges;
  if (connected_ && edges >= *connected_) point.connectivity = component_.connectivity(taken);
  std::vector<bool> is_joined(component_.merged_vertices(), false);
  std::vector<std::pair<VertexId, VertexId>> ends;
  ends.reserve(taken.size());
  for (const RecordedEdge& e : taken) {
    is_joined[to_index(e.u)] = is_joined[to_index(e.v)] = true;
    ends.emplace_back(e.u, e.v);
  }
  point.joined_vertices = static_cast<std::uint32_t>(std::ranges::count(is_joined, true));
  point.independent_joins = maximum_matching(ends);
  return known_.emplace(edges, point).first->second;
}

std::optional<std::uint64_t> RunCurve::edges_to(double level) {
  const double goal = level * component_.final_connectivity() * (1 - kRounding);
  if (!connected_) return goal > 0 ? std::nullopt : std::optional<std::uint64_t>(0);
  if (at(run_.edges.size()).connectivity < goal) return std::nullopt;
  // What is known already narrows the search.
  const auto first_known =
      std::ranges::find_if(known_, [&](const auto& entry) { return entry.second.connectivity >= goal; });
  std::uint64_t high = first_known->first;
  std::uint64_t low = goal > 0 ? std::min(*connected_, high) : 0;
  if (first_known != known_.begin()) low = std::max(low, std::prev(first_known)->first + 1);
  while (low < high) {
    const std::uint64_t middle = low + (high - low) / 2;
    if (at(middle).connectivity >= goal) {
      high = middle;
    } else {
      low = middle + 1;
    }
  }
  return low;
}

std::vector<CurvePoint> RunCurve::points(std::uint32_t wanted) {
  const auto all = static_cast<double>(run_.edges.size());
  at(0);
  at(run_.edges.size());
  if (connected_ && *connected_ > 0) {
    at(*connected_ - 1);
    at(*connected_);
  }
  const double from = connected_ ? static_cast<double>(*connected_) : all;
  for (std::uint32_t i = 1; i < wanted; ++i) {
    const double share = static_cast<double>(i) / wanted;
    at(static_cast<std::uint64_t>(std::pow(std::max(all, 1.0), share)));
    at(static_cast<std::uint64_t>(from + (all - from) * share));
  }
  std::vector<CurvePoint> points;
  for (const auto& [edges, point] : known_) points.push_back(point);
  return points;
}

std::uint64_t edges_within(const RecordedRun& run, CostAxis axis, double modelled_verifier_s, double budget) {
  const auto first_beyond = std::ranges::partition_point(
      run.edges, [&](const RecordedEdge& e) { return on_axis(e.cost, axis, modelled_verifier_s) <= budget; });
  return static_cast<std::uint64_t>(first_beyond - run.edges.begin());
}

Cost cost_of(const RecordedRun& run, std::uint64_t edges) { return edges == 0 ? Cost{} : run.edges[edges - 1].cost; }

}  // namespace mapweld::server::evaluation
