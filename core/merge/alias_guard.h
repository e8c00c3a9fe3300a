// The alias guard: which verified edges between maps are confirmed (http-api.md, "Two layers of edges").
//
// A verified edge says that two images agree; it does not say that they show one place: doors, floors and posters of
// one design agree as well. The guard judges each edge in the light of its two images as wholes, of the words it rests
// on, and of all the other verified edges. docs/alias-guard.md has the rule, its reasons and its figures.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "core/merge/merge_input.h"
#include "core/merge/merge_state.h"
#include "core/types.h"

namespace mapweld {

// Defaults measured on rendered worlds, see docs/alias-guard.md.
struct AliasGuardOptions {
  // What the pair itself has to show. An edge that shows less is `unsupported`, and says nothing about others.
  double max_log10_false_alarms = -12;  // stricter than the verifier: there are many pairs in a merge
  // Of the features in the common view (EdgeOverlap). Where light, cameras and years lie between two maps, fewer
  // features match anywhere: the bound is never more than matched_share_of_best times what the best edges of the two
  // maps have (those with min_peak_inliers: nine in ten have less).
  double min_matched_share = 0.08;
  double matched_share_of_best = 0.35;
  double min_shared_view = 0.25;  // of either image, as far as the matches tell (EdgeOverlap)
  double min_spread = 0.08;       // of the matches, in diagonals (EdgeOverlap)
  // The spread that matches strewn evenly over the shared view would have, and at least so great a share of it: matches
  // on one poster in the middle of a common view have less.
  double min_evenness = 0.5;

  // Hops go along the drive: over inner edges between images that their member took in at most so many apart (far
  // enough to look into a room and come back), and over revisits: see drive_links.
  std::uint32_t longest_link = 30;
  double revisit_fullness = 0.9;
  double revisit_completeness = 0.9;
  std::uint32_t min_revisit_images = 100;
  // Two edges support each other when their ends are at most so many hops apart in both maps, and contradict each other
  // when they are in one map but more than far_hops apart in the other. far_hops at most 254.
  int near_hops = 2;
  int far_hops = 6;
  // Edges whose ends are at most so many hops apart in both maps form a cluster; a cluster stands or falls as one.
  int link_hops = 1;

  // A place seen twice shows it somewhere, or all along: a cluster is `unsupported` unless one of its edges, or of a
  // cluster that supports it, has min_peak_inliers and min_rare_matches (of words that its maps have nowhere else, out
  // of reach of far_hops) and
  // - so many inliers times their matched share, and so great a matched share,
  // - or so many matches of such words,
  // - or a cluster that joins so many vertices of either map.
  // And some edge of its own must have min_rare_matches.
  int min_peak_inliers = 20;
  int min_rare_matches = 3;
  double min_peak_fullness = 12;
  double min_peak_matched_share = 0.22;
  int min_peak_rare_matches = 40;
  std::uint32_t min_extent = 20;

  // A cluster is dropped when what contradicts it weighs more than so many times what supports it.
  double dropped_beyond = 1.5;
  // Of two clusters that contradict each other at the same vertices, the one that has fewer inliers at so
  // significantly many of them is dropped (a sign test; standard deviations).
  double duel_significance = 2.5;
  // One that is still contradicted by more than this share of its support is ambiguous.
  double ambiguous_beyond = 0.5;
};

// What the guard knows about one edge; for explanations and figures.
struct GuardEvidence {
  // Of the pair.
  double matched_share = 0;
  double shared_view = 0;
  double spread = 0;
  int rare_matches = 0;  // inliers whose word occurs near the edge's ends only; 0 for a pair that shows too little
  // Of its cluster; 0 for a pair that shows too little. Weights are products of inliers, summed over pairs of edges.
  std::uint32_t cluster_edges = 0;
  std::uint64_t support = 0;
  std::uint64_t contradiction = 0;  // by the clusters that stand
  friend bool operator==(const GuardEvidence&, const GuardEvidence&) = default;
};

// kNone: confirmed. kUnsupported: the pair or its cluster shows too little, or other edges say that it is elsewhere.
// kAmbiguous: two places, and nothing decides between them.
struct GuardVerdict {
  Reason reason = Reason::kNone;
  GuardEvidence evidence;
  bool confirmed() const { return reason == Reason::kNone; }
  friend bool operator==(const GuardVerdict&, const GuardVerdict&) = default;
};

// Judges the edges of a merge again and again while they become more: what follows from the members alone, and from one
// pair of images, is worked out once. One thread.
class AliasGuard {
 public:
  // Reads the appearance vectors of all members; what the source throws passes through. `appearances` must outlive this
  // object.
  AliasGuard(std::vector<MergeMember> members, std::span<const Edge> inner_edges, const AppearanceSource& appearances,
             const AliasGuardOptions& options = {});
  ~AliasGuard();
  AliasGuard(AliasGuard&&) noexcept;

  // A verdict for each of `inter_edges`, in their order: a function of the set of edges alone, whatever their order,
  // that of the members, and what was asked before. An edge between the same two vertices must come with the same
  // verification each time. Edges are judged by pairs of members; for one that joins a member with itself, or whose
  // vertex is in no member, std::invalid_argument is thrown. Deterministic.
  std::vector<GuardVerdict> verdicts(std::span<const MergeEdge> inter_edges);

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

// The same, once.
std::vector<GuardVerdict> guard_edges(const std::vector<MergeMember>& members, std::span<const Edge> inner_edges,
                                      std::span<const MergeEdge> inter_edges, const AppearanceSource& appearances,
                                      const AliasGuardOptions& options = {});

}  // namespace mapweld
