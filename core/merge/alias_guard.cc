#include "core/merge/alias_guard.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <unordered_map>
#include <utility>

#include "core/geometry/view_overlap.h"
#include "core/merge/cluster_contest.h"
#include "core/merge/cluster_fullness.h"
#include "core/merge/drive_links.h"
#include "core/merge/edge_relations.h"
#include "core/merge/hop_balls.h"
#include "core/merge/rare_matches.h"
#include "core/merge/word_places.h"

namespace mapweld {
namespace {

constexpr std::uint32_t kNoMember = 0xFFFFFFFF;
constexpr int kBesides = 1;  // hops to a neighbour

std::vector<std::uint32_t> member_of_vertex(const std::vector<MergeMember>& members, std::uint32_t vertices) {
  std::vector<std::uint32_t> member_of(vertices, kNoMember);
  for (std::uint32_t m = 0; m < members.size(); ++m) {
    for (const VertexId v : members[m].vertices) member_of[to_index(v)] = m;
  }
  return member_of;
}

void require_between_members(const MergeEdge& edge, const std::vector<std::uint32_t>& member_of) {
  const auto member = [&](VertexId v) { return to_index(v) < member_of.size() ? member_of[to_index(v)] : kNoMember; };
  if (member(edge.u) == kNoMember || member(edge.v) == kNoMember || member(edge.u) == member(edge.v)) {
    throw std::invalid_argument("an inter-map edge joins two members");
  }
}

bool pair_shows_enough(const MergeEdge& edge, const GuardEvidence& evidence, const AliasGuardOptions& options) {
  return edge.verification.log10_false_alarms <= options.max_log10_false_alarms &&
         evidence.matched_share >= options.min_matched_share && evidence.shared_view >= options.min_shared_view &&
         evidence.spread >= options.min_spread;
}

DriveLinkOptions link_options(const AliasGuardOptions& o) {
  return {o.longest_link, o.revisit_fullness, o.revisit_completeness, o.min_revisit_images};
}

}  // namespace

struct AliasGuard::Parts {
  // `links`: of drive_links.
  Parts(std::vector<MergeMember> given, const std::vector<Edge>& links, const AppearanceSource& source,
        const AliasGuardOptions& chosen)
      : members(std::move(given)),
        appearances(source),
        options(chosen),
        balls(members, links, static_cast<std::uint8_t>(chosen.far_hops)),
        short_balls(members, short_links(members, links, source, chosen.min_link_share, link_options(chosen)),
                    static_cast<std::uint8_t>(chosen.rival_hops)),
        member_of(member_of_vertex(members, balls.vertices())),
        places(source, members) {}

  const ViewOverlap& overlap(const MergeEdge& edge) {
    const auto [found, is_new] = overlaps.try_emplace(std::uint64_t{to_index(edge.u)} << 32 | to_index(edge.v));
    if (is_new) {
      found->second = view_overlap(*appearances.appearances(edge.u), *appearances.appearances(edge.v),
                                   edge.verification.inlier_matches);
    }
    return found->second;
  }

  std::vector<MergeMember> members;
  const AppearanceSource& appearances;
  AliasGuardOptions options;
  HopBalls balls;
  HopBalls short_balls;
  std::vector<std::uint32_t> member_of;
  WordPlaces places;
  std::unordered_map<std::uint64_t, ViewOverlap> overlaps;
};

AliasGuard::AliasGuard(std::vector<MergeMember> members, std::span<const Edge> inner_edges,
                       const AppearanceSource& appearances, const AliasGuardOptions& options) {
  const std::vector<Edge> links = drive_links(members, inner_edges, appearances, link_options(options));
  parts_ = std::make_unique<Parts>(std::move(members), links, appearances, options);
}
AliasGuard::~AliasGuard() = default;
AliasGuard::AliasGuard(AliasGuard&&) noexcept = default;

std::vector<GuardVerdict> AliasGuard::verdicts(std::span<const MergeEdge> inter_edges) {
  std::vector<GuardVerdict> verdicts = judge(inter_edges);
  for (GuardVerdict& verdict : verdicts) {
    // A rule that says yes or no is as sure as that.
    verdict.confidence = verdict.reason == Reason::kNone ? 1 : 0;
    if (verdict.confidence >= parts_->options.min_confidence) verdict.reason = Reason::kNone;
  }
  return verdicts;
}

std::vector<GuardVerdict> AliasGuard::judge(std::span<const MergeEdge> inter_edges) {
  std::vector<GuardVerdict> verdicts(inter_edges.size());
  if (inter_edges.empty()) return verdicts;
  const AliasGuardOptions& options = parts_->options;
  const auto& member_of = parts_->member_of;
  HopBalls& balls = parts_->balls;

  // The pair by itself.
  std::vector<std::uint32_t> considered;  // edges that show enough: everything below is about these
  std::vector<const MergeEdge*> edges;
  std::vector<WeighedEdge> weighed;
  std::vector<double> fullness;
  for (std::uint32_t e = 0; e < inter_edges.size(); ++e) {
    const MergeEdge& edge = inter_edges[e];
    require_between_members(edge, member_of);
    const ViewOverlap& overlap = parts_->overlap(edge);
    GuardEvidence& evidence = verdicts[e].evidence;
    evidence.matched_share = overlap.matched_share;
    evidence.shared_view = overlap.shared_view;
    evidence.spread = overlap.spread;
    evidence.fullness = std::sqrt(edge.verification.inliers) * overlap.matched_share * overlap.shared_view;
    if (!pair_shows_enough(edge, evidence, options)) {
      verdicts[e].reason = Reason::kUnsupported;
      continue;
    }
    considered.push_back(e);
    edges.push_back(&edge);
    weighed.push_back({edge.u, edge.v, static_cast<std::uint32_t>(std::max(1, edge.verification.inliers))});
    fullness.push_back(evidence.fullness);
  }
  if (considered.empty()) return verdicts;

  // Clusters that show their place somewhere.
  EdgeRelations relations(weighed, member_of, balls, options.near_hops);
  const auto cluster_of = relations.clusters(options.link_hops);
  const auto bonds = relations.bonds(cluster_of);
  const std::uint32_t clusters = *std::ranges::max_element(cluster_of) + 1;
  const auto rare = rare_matches(edges, parts_->appearances, parts_->places, member_of, balls);
  std::vector<bool> has_rare(clusters, false), out(clusters, true);
  std::vector<std::uint32_t> sizes(clusters, 0);
  for (std::size_t k = 0; k < considered.size(); ++k) {
    verdicts[considered[k]].evidence.rare_matches = rare[k];
    ++sizes[cluster_of[k]];
    if (rare[k] >= options.min_rare_matches) has_rare[cluster_of[k]] = true;
  }
  const auto shows = clusters_that_show_their_place(weighed, fullness, cluster_of, clusters,
                                                    {.min_peak_fullness = options.min_peak_fullness,
                                                     .sure_peak_fullness = options.sure_peak_fullness,
                                                     .min_vertex_fullness = options.min_vertex_fullness,
                                                     .min_full_vertices = options.min_full_vertices});
  for (std::uint32_t c = 0; c < clusters; ++c) out[c] = !shows[c] || !has_rare[c];

  // Clusters against each other.
  const auto standings = contest(weighed, cluster_of, out, bonds,
                                 {options.dropped_beyond, options.ambiguous_beyond, options.duel_significance});
  std::vector<bool> stands(considered.size());
  for (std::size_t k = 0; k < considered.size(); ++k) {
    const ClusterStanding& standing = standings[cluster_of[k]];
    GuardVerdict& verdict = verdicts[considered[k]];
    verdict.reason = standing.reason;
    verdict.evidence.cluster_edges = sizes[cluster_of[k]];
    verdict.evidence.support = standing.support;
    verdict.evidence.contradiction = standing.contradiction;
    stands[k] = verdict.confirmed();
  }

  // The edges of what stands, one by one.
  const auto balances = EdgeRelations(weighed, member_of, parts_->short_balls, kBesides).balances(stands);
  FullestEdges fullest(member_of);
  for (std::size_t k = 0; k < considered.size(); ++k) {
    if (!stands[k]) continue;
    stands[k] = static_cast<double>(balances[k].contradiction) <=
                options.dropped_beyond * static_cast<double>(balances[k].support);
    if (stands[k]) fullest.add(weighed[k], fullness[k]);
  }
  for (std::size_t k = 0; k < considered.size(); ++k) {
    GuardVerdict& verdict = verdicts[considered[k]];
    if (!verdict.confirmed()) continue;
    const bool is_best_of_an_image = stands[k] && fullness[k] >= options.min_best_fullness &&
                                     verdict.evidence.matched_share >= options.min_best_matched_share &&
                                     fullest.is_of_one_end(weighed[k], fullness[k]);
    if (!stands[k] || (fullness[k] < options.min_fullness && !is_best_of_an_image)) {
      verdict.reason = Reason::kUnsupported;
    }
  }
  return verdicts;
}

std::vector<GuardVerdict> guard_edges(const std::vector<MergeMember>& members, std::span<const Edge> inner_edges,
                                      std::span<const MergeEdge> inter_edges, const AppearanceSource& appearances,
                                      const AliasGuardOptions& options) {
  return AliasGuard(members, inner_edges, appearances, options).verdicts(inter_edges);
}

}  // namespace mapweld
