#include "core/merge/certificate/outlook.h"

namespace mapweld {

void Outlook::look(const Merger& merger) {
  const MergeState& state = merger.state();
  if (step_ == state.step) return;
  const std::vector<EdgeStanding> standings = judge_ ? judge_(merger) : std::vector<EdgeStanding>{};
  graph_ = AppearanceGraph(merger.graph().vertices(), merger.input().inner_edges);
  for (std::size_t e = 0; e < state.edges.size(); ++e) {
    if (standings.empty() || standings[e].confirmed) graph_.add_edge(state.edges[e].u, state.edges[e].v, 1);
  }
  open_ = forecast_.open(merger, graph_, standings);
  certificate_.reset();
  has_something_ = false;
  if (open_) {
    largest_ = largest_component_connectivity(graph_);
    certificate_ = certify(graph_, largest_, *open_);
    has_something_ = certificate_->open_within > 0 || certificate_->joinable_vertices == 0;
  }
  step_ = state.step;
}

std::optional<Certificate> Outlook::certificate(const Merger& merger) {
  look(merger);
  return has_something_ ? certificate_ : std::nullopt;
}

std::optional<FinalEstimate> Outlook::estimate(const Merger& merger) {
  look(merger);
  if (!has_something_) return std::nullopt;
  return estimate_final(graph_, largest_, *open_);
}

}  // namespace mapweld
