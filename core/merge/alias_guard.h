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

#include "core/merge/guard_evidence.h"
#include "core/merge/merge_input.h"
#include "core/merge/merge_state.h"
#include "core/types.h"

namespace mapweld {

// Defaults measured on rendered worlds, see docs/alias-guard.md.
struct AliasGuardOptions {
  double min_confidence = kDefaultMinConfidence;  // of a confirmed edge; in [0, 1]

  // What the pair itself has to show to be considered. An edge that shows less is `unsupported`, and says nothing about
  // others.
  double max_log10_false_alarms = -8;  // this and the next bound where the verifier's were relaxed
  double min_matched_share = 0.05;     // of the features in the common view (ViewOverlap)
  double min_shared_view = 0.1;        // of either image, as far as the matches tell (ViewOverlap)
  double min_spread = 0.07;            // of the matches, in diagonals (ViewOverlap)

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

  // A place seen twice shows it: a cluster is `unsupported` unless one of its edges has min_peak_fullness
  // (GuardEvidence), and at so great a share of its images the fullest edge has min_vertex_fullness (or one has
  // sure_peak_fullness); and unless one has min_rare_matches: of words that its maps have nowhere else, out of reach of
  // far_hops.
  double min_peak_fullness = 3.2;
  double min_vertex_fullness = 2;
  double min_full_vertices = 0.4;
  double sure_peak_fullness = 4.6;
  int min_rare_matches = 3;

  // A cluster is dropped when what contradicts it weighs more than so many times what supports it.
  double dropped_beyond = 1.5;
  // Of two clusters that contradict each other at the same vertices, the one that has fewer inliers at so
  // significantly many of them is dropped (a sign test; standard deviations).
  double duel_significance = 2.5;
  // One that is still contradicted by more than this share of its support is ambiguous.
  double ambiguous_beyond = 0.5;

  // Within what stands edges are weighed one by one, by shorter hops: over inner edges whose inliers are min_link_share
  // of an image's features. One is dropped when those that share an image or its neighbour with it but lead more than
  // rival_hops elsewhere weigh more than dropped_beyond times those that lead where it does.
  double min_link_share = 0.15;
  int rival_hops = 5;
  // Of the rest an edge is confirmed if it has min_fullness, or is the fullest of one of its images and has
  // min_best_fullness and min_best_matched_share. The others show a thing that this place has in common with the next.
  double min_fullness = 0.9;
  double min_best_fullness = 0.4;
  double min_best_matched_share = 0.17;
};

// kNone: confirmed. kUnsupported: the pair or its cluster shows too little, or other edges say that it is elsewhere.
// kAmbiguous: two places, and nothing decides between them.
struct GuardVerdict {
  Reason reason = Reason::kNone;
  double confidence = 1;  // in [0, 1]; confirmed: at least min_confidence
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
  // Reasons and evidence by the rule.
  std::vector<GuardVerdict> judge(std::span<const MergeEdge> inter_edges);
  std::unique_ptr<Parts> parts_;
};

// The same, once.
std::vector<GuardVerdict> guard_edges(const std::vector<MergeMember>& members, std::span<const Edge> inner_edges,
                                      std::span<const MergeEdge> inter_edges, const AppearanceSource& appearances,
                                      const AliasGuardOptions& options = {});

}  // namespace mapweld
