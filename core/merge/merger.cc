#include "core/merge/merger.h"

#include <utility>

#include "core/errors.h"

namespace mapweld {
namespace {

std::uint32_t vertices_of(const std::vector<MergeMember>& members) {
  std::size_t vertices = 0;
  for (const MergeMember& member : members) vertices += member.vertices.size();
  return static_cast<std::uint32_t>(vertices);
}

}  // namespace

Merger::Merger(MergeInput input) : input_(std::move(input)), graph_(vertices_of(input_.members), input_.inner_edges) {
  state_.vertices = graph_.vertices();
}

std::vector<bool> Merger::finished_pairs() const {
  const std::size_t members = input_.members.size();
  return std::vector<bool>(members * (members - 1) / 2, done());
}

void Merger::resume(MergeState state) {
  if (state.verifications != state.edges.size() + state.rejected.size()) {
    throw FormatError("a merge state whose verdicts do not add up");
  }
  for (const MergeEdge& e : state.edges) {
    const bool fits = e.u < e.v && to_index(e.v) < graph_.vertices() &&
                      graph_.add_edge(e.u, e.v, static_cast<std::uint32_t>(e.verification.inliers));
    if (!fits) throw FormatError("a merge state with an edge that its maps cannot have");
  }
  state_ = std::move(state);
}

}  // namespace mapweld
