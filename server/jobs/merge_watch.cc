#include "server/jobs/merge_watch.h"

#include <algorithm>
#include <span>

#include "core/merge/fraction_stop.h"

namespace mapweld::server {

void MergeWatch::judge() {
  const std::vector<MergeEdge>& edges = merger_.state().edges;
  if (!guards_ || doubts_.size() == edges.size()) return;
  const MergeInput& input = merger_.input();
  if (!guard_) guard_.emplace(input.members, input.inner_edges, *input.appearances);
  doubts_.clear();
  for (const GuardVerdict& verdict : guard_->verdicts(edges)) doubts_.push_back(verdict.reason);
}

std::vector<bool> MergeWatch::confirmed() const {
  std::vector<bool> all;
  for (const Reason doubt : doubts_) all.push_back(doubt == Reason::kNone);
  return all;
}

AppearanceGraph MergeWatch::confirmed_graph() const {
  const MergeInput& input = merger_.input();
  AppearanceGraph graph(merger_.graph().vertices(), input.inner_edges);
  const std::vector<MergeEdge>& edges = merger_.state().edges;
  for (std::size_t e = 0; e < edges.size(); ++e) {
    if (doubts_[e] != Reason::kNone) continue;
    graph.add_edge(edges[e].u, edges[e].v, static_cast<std::uint32_t>(edges[e].verification.inliers));
  }
  return graph;
}

void MergeWatch::measure_edges(bool exact) {
  const MergeState& state = merger_.state();
  const std::vector<MergeMember>& members = merger_.input().members;
  if (exact || measured_edges_ != state.edges.size()) {
    judge();
    measured_edges_ = state.edges.size();
    const auto measure = [&](const AppearanceGraph& graph, std::span<const MergeEdge> edges) {
      return exact ? merge_metrics(graph, members, edges) : follower_.measure(graph, members, edges);
    };
    if (guards_) {
      std::vector<MergeEdge> standing;
      for (std::size_t e = 0; e < state.edges.size(); ++e) {
        if (doubts_[e] == Reason::kNone) standing.push_back(state.edges[e]);
      }
      metrics_ = measure(confirmed_graph(), standing);
    } else {
      metrics_ = measure(merger_.graph(), state.edges);
    }
    // An older certificate still holds while edges come to the same component; for another one it says nothing, nor
    // when edges may have been taken back.
    const std::pair now{metrics_.components, metrics_.largest_vertices};
    if (guards_ || certified_for_ != now) certified_.reset();
  }
  members_ = member_table(members, state.edges, state.rejected, confirmed(), merger_.done());
}

void MergeWatch::measure_certificate() {
  std::optional<std::vector<OpenCandidate>> open = open_with_chances(merger_);
  certified_.reset();
  if (!open) return;
  Certificate certificate;
  if (guards_) {
    // What is verified may be confirmed yet.
    judge();
    const std::vector<MergeEdge>& edges = merger_.state().edges;
    const auto standing = static_cast<double>(std::ranges::count(doubts_, Reason::kNone));
    const double chance = (standing + 1) / (static_cast<double>(edges.size()) + 2);
    if (!merger_.done()) {
      for (std::size_t e = 0; e < edges.size(); ++e) {
        if (doubts_[e] != Reason::kNone) open->push_back({edges[e].u, edges[e].v, chance / 2});
      }
    }
    certificate = certify(confirmed_graph(), *open);
  } else {
    certificate = certify(merger_.graph(), *open);
  }
  certified_for_ = {metrics_.components, metrics_.largest_vertices};
  certified_ = Certified{certificate.certified_fraction, certificate.estimated_fraction, certificate.joinable_vertices};
}

Reason MergeWatch::doubt(std::size_t edge) {
  if (!guards_) return Reason::kNone;
  judge();
  return doubts_[edge];
}

std::vector<EdgeDoubt> MergeWatch::changed_doubts(std::size_t count) {
  std::vector<EdgeDoubt> changed;
  if (!guards_) return changed;
  judge();
  const std::vector<MergeEdge>& edges = merger_.state().edges;
  for (std::size_t e = 0; e < count; ++e) {
    if (e >= told_.size() || told_[e] != doubts_[e]) changed.push_back({edges[e].u, edges[e].v, doubts_[e]});
  }
  told_ = doubts_;
  return changed;
}

}  // namespace mapweld::server
