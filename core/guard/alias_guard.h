// The alias guard: which verified edges between maps are confirmed (http-api.md, "Two layers of edges").
//
// A verified edge says that two images agree; it does not say that they show one place: doors, floors and posters of
// one design agree as well. The guard asks the maps themselves: what matches, does either map have it elsewhere too?
// Does the place show itself somewhere near as fully as the maps show places again? And what do the edges around say?
// docs/alias-guard.md has the rule, its reasons and its figures.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "core/guard/verdict.h"
#include "core/guard/verified_edge.h"
#include "core/merge/merge_input.h"
#include "core/merge/merge_state.h"
#include "core/types.h"

namespace mapweld {

// Judges the edges of a merge as they become more: only what a new edge can change is worked out anew. One thread.
class AliasGuard {
 public:
  // `inner_edges`: the verified edges inside the members, in merged numbers. Reads the appearance vectors of all
  // members; what the source throws passes through. `appearances` must outlive this object. With an executor, which is
  // used here only, members are looked at side by side; the result is the same.
  AliasGuard(std::vector<MergeMember> members, std::span<const VerifiedEdge> inner_edges,
             const AppearanceSource& appearances, const GuardOptions& options = {}, const Executor* executor = nullptr);
  ~AliasGuard();
  AliasGuard(AliasGuard&&) noexcept;

  // By inner edge, as given: what each member's own images and edges say, whatever is merged with it.
  const std::vector<GuardVerdict>& inner_verdicts() const;

  // A verdict for each of `inter_edges`, in their order: a function of the set of edges alone, whatever their order,
  // that of the members, and what was asked before. While edges only come, confidences only grow. Edges that were there
  // the last time, from the front on, cost nothing. Edges are judged by pairs of members; for one that joins a member
  // with itself, or whose vertex is in no member, std::invalid_argument is thrown. Deterministic.
  const std::vector<GuardVerdict>& verdicts(std::span<const MergeEdge> inter_edges);

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

// The verdicts on all edges, once.
std::vector<GuardVerdict> guard_edges(const std::vector<MergeMember>& members,
                                      std::span<const VerifiedEdge> inner_edges, std::span<const MergeEdge> inter_edges,
                                      const AppearanceSource& appearances, const GuardOptions& options = {});

// Of edges those that their verdicts, one each, confirm: what a guarded merge rests on within its members. Weights are
// inliers.
std::vector<Edge> confirmed_edges(std::span<const VerifiedEdge> edges, std::span<const GuardVerdict> verdicts);

}  // namespace mapweld
