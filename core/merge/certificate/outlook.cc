#include "core/merge/certificate/outlook.h"

namespace mapweld {

void Outlook::look(const Merger& merger) {
  const MergeState& state = merger.state();
  if (step_ == state.step) return;
  step_ = state.step;
  certificate_.reset();
  const std::optional<std::vector<Candidate>> left = merger.open_candidates();
  if (!left) return;
  standings_ = judge_ ? judge_(merger) : std::vector<EdgeStanding>{};
  graph_ = AppearanceGraph(merger.graph().vertices(), merger.input().inner_edges);
  std::vector<OpenCandidate> open;
  for (const Candidate& c : *left) open.push_back({c.source, c.target});
  for (std::size_t e = 0; e < state.edges.size(); ++e) {
    const MergeEdge& edge = state.edges[e];
    if (standings_.empty() || standings_[e].confirmed) {
      graph_.add_edge(edge.u, edge.v, 1);
    } else if (!merger.done()) {
      open.push_back({edge.u, edge.v});
    }
  }
  largest_ = largest_component_connectivity(graph_);
  const Certificate now = certify(graph_, largest_, open);
  if (now.open_within > 0 || now.joinable_vertices == 0) certificate_ = now;
}

std::optional<Certificate> Outlook::certificate(const Merger& merger) {
  look(merger);
  return certificate_;
}

std::optional<FinalEstimate> Outlook::estimate(const Merger& merger) {
  look(merger);
  if (!certificate_) return std::nullopt;
  return estimate_final(graph_, largest_, forecast_.open(merger, graph_, standings_).value());
}

}  // namespace mapweld
