#include "server/jobs/merge_watch.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <span>
#include <utility>

namespace mapweld::server {

std::uint64_t MergeWatch::revoked_of_the_written(const std::vector<GuardVerdict>& verdicts) const {
  std::set<std::pair<VertexId, VertexId>> withheld;
  const std::vector<MergeEdge>& edges = merger_.state().edges;
  for (std::size_t e = 0; e < edges.size(); ++e) {
    if (!verdicts[e].confirmed()) withheld.emplace(std::minmax(edges[e].u, edges[e].v));
  }
  return static_cast<std::uint64_t>(std::ranges::count_if(written_, [&](const JudgedEdge& edge) {
    return edge.judgement.doubt == Reason::kNone && withheld.contains({edge.u, edge.v});
  }));
}

std::vector<bool> MergeWatch::confirmed_as_written() const {
  std::set<std::pair<VertexId, VertexId>> confirmed;
  for (const JudgedEdge& edge : written_) {
    if (edge.judgement.doubt == Reason::kNone) confirmed.emplace(edge.u, edge.v);
  }
  std::vector<bool> heard;
  for (const MergeEdge& edge : merger_.state().edges) heard.push_back(confirmed.contains(std::minmax(edge.u, edge.v)));
  return heard;
}

void MergeWatch::judge() {
  const std::vector<MergeEdge>& edges = merger_.state().edges;
  if (!guards() || verdicts_.size() == edges.size()) return;
  const std::vector<GuardVerdict>& verdicts = guard_->verdicts(edges);
  for (std::size_t e = 0; e < verdicts_.size(); ++e) {
    revoked_ += verdicts_[e].confirmed() && !verdicts[e].confirmed() ? 1 : 0;
  }
  revoked_ += revoked_of_the_written(verdicts);
  written_.clear();
  verdicts_ = verdicts;
}

AppearanceGraph MergeWatch::confirmed_graph() const {
  const MergeInput& input = merger_.input();
  AppearanceGraph graph(merger_.graph().vertices(), input.inner_edges);
  const std::vector<MergeEdge>& edges = merger_.state().edges;
  for (std::size_t e = 0; e < edges.size(); ++e) {
    if (!is_confirmed(e)) continue;
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
    if (guards()) {
      std::vector<MergeEdge> standing;
      for (std::size_t e = 0; e < state.edges.size(); ++e) {
        if (is_confirmed(e)) standing.push_back(state.edges[e]);
      }
      metrics_ = measure(confirmed_graph(), standing);
      confirmed_edges_ = standing.size();
    } else {
      metrics_ = measure(merger_.graph(), state.edges);
      confirmed_edges_ = state.edges.size();
    }
    discount_absent();
    // An older certificate still holds while edges come to the same component; for another one it says nothing, nor
    // when edges that mattered were taken back.
    const bool is_another = certified_for_ != std::pair{metrics_.components, metrics_.largest_vertices};
    if (is_another || metrics_.largest_algebraic_connectivity < certified_connectivity_ * (1 - 1e-9))
      certified_.reset();
  }
  std::vector<bool> confirmed(state.edges.size());
  for (std::size_t e = 0; e < confirmed.size(); ++e) confirmed[e] = is_confirmed(e);
  members_ = member_table(members, state.edges, state.rejected, confirmed, merger_.finished_pairs());
}

// Vertices whose images are gone are no components.
void MergeWatch::discount_absent() {
  const std::vector<VertexId>& absent = merger_.input().absent;
  if (absent.empty()) return;
  metrics_.components -= static_cast<std::uint32_t>(absent.size());
  if (metrics_.components <= 1) metrics_.algebraic_connectivity = metrics_.largest_algebraic_connectivity;
  if (metrics_.components == 0) metrics_.largest_vertices = 0;
}

std::vector<EdgeStanding> MergeWatch::standings() {
  std::vector<EdgeStanding> standings;
  if (!guards()) return standings;
  judge();
  for (const GuardVerdict& verdict : verdicts_) standings.push_back({verdict.confirmed(), verdict.confidence});
  return standings;
}

void MergeWatch::measure_certificate() {
  certified_.reset();
  const std::optional<Certificate> certificate = outlook_.certificate(merger_);
  if (!certificate) return;
  certified_for_ = {metrics_.components, metrics_.largest_vertices};
  certified_connectivity_ = metrics_.largest_algebraic_connectivity;
  certified_ =
      Certified{certificate->certified_fraction, outlook_.estimate(merger_)->fraction, certificate->joinable_vertices};
}

std::vector<MergeWatch::Change> MergeWatch::tell_changes() {
  std::vector<Change> changes;
  heard_.resize(std::max(heard_.size(), verdicts_.size()));
  for (std::size_t e = 0; e < verdicts_.size(); ++e) {
    if (heard_[e] == verdicts_[e].confirmed()) continue;
    heard_[e] = verdicts_[e].confirmed();
    changes.push_back({e, verdicts_[e]});
  }
  return changes;
}

MergeWatch::Judgements MergeWatch::tell_judgements(std::size_t stored, bool all) {
  const std::vector<MergeEdge>& edges = merger_.state().edges;
  Judgements judgements;
  judgements.of_the_new.resize(edges.size() - stored);
  if (!guards()) return judgements;
  judge();
  const std::size_t told_before = told_.size();
  told_.resize(edges.size());
  for (std::size_t e = 0; e < edges.size(); ++e) {
    const GuardVerdict& verdict = verdicts_[e];
    if (e < stored && e < told_before && told_[e].doubt == verdict.reason) {
      const double moved = std::abs(told_[e].confidence - verdict.confidence);
      if (moved == 0 || (!all && moved < kTellingConfidence)) continue;
    }
    told_[e] = {verdict.confidence, verdict.reason};
    EdgeJudgement judgement{verdict.confidence, verdict.reason, evidence_items(verdict.evidence)};
    if (e < stored) {
      judgements.changed.push_back({edges[e].u, edges[e].v, std::move(judgement)});
    } else {
      judgements.of_the_new[e - stored] = std::move(judgement);
    }
  }
  return judgements;
}

}  // namespace mapweld::server
