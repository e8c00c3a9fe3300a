#include "core/merge/alias_guard.h"

#include <algorithm>
#include <stdexcept>

#include "core/merge/cluster_contest.h"
#include "core/merge/edge_overlap.h"
#include "core/merge/edge_relations.h"
#include "core/merge/hop_balls.h"
#include "core/merge/rare_matches.h"
#include "core/merge/word_places.h"

namespace mapweld {
namespace {

constexpr std::uint32_t kNoMember = 0xFFFFFFFF;

std::vector<std::uint32_t> member_of_vertex(const std::vector<MergeMember>& members, std::uint32_t vertices) {
  std::vector<std::uint32_t> member_of(vertices, kNoMember);
  for (std::uint32_t m = 0; m < members.size(); ++m) {
    for (const VertexId v : members[m].vertices) member_of[to_index(v)] = m;
  }
  return member_of;
}

struct InnerLinks {
  std::vector<Edge> along_drive;
  std::vector<Edge> with_revisits;  // and those that close a loop beyond doubt
};

InnerLinks inner_links(const std::vector<MergeMember>& members, std::span<const Edge> inner_edges,
                       const AppearanceSource& appearances, const AliasGuardOptions& options) {
  std::vector<std::uint32_t> position, features;
  for (const MergeMember& member : members) {
    for (std::uint32_t i = 0; i < member.vertices.size(); ++i) {
      const std::uint32_t v = to_index(member.vertices[i]);
      if (v >= position.size()) {
        position.resize(v + 1, 0);
        features.resize(v + 1, 0);
      }
      position[v] = i;
      features[v] = static_cast<std::uint32_t>(appearances.appearances(member.vertices[i])->appearances.size());
    }
  }
  InnerLinks links;
  for (const Edge& e : inner_edges) {
    const std::uint32_t u = to_index(e.u), v = to_index(e.v);
    const std::uint32_t i = position.at(u), j = position.at(v);
    if ((i < j ? j - i : i - j) <= options.longest_link) {
      links.along_drive.push_back(e);
      links.with_revisits.push_back(e);
    } else if (e.weight >= options.min_revisit_share * std::min(features[u], features[v])) {
      links.with_revisits.push_back(e);
    }
  }
  return links;
}

void require_between_members(const MergeEdge& edge, const std::vector<std::uint32_t>& member_of) {
  const auto member = [&](VertexId v) { return to_index(v) < member_of.size() ? member_of[to_index(v)] : kNoMember; };
  if (member(edge.u) == kNoMember || member(edge.v) == kNoMember || member(edge.u) == member(edge.v)) {
    throw std::invalid_argument("an inter-map edge joins two members");
  }
}

bool pair_shows_enough(const MergeEdge& edge, const EdgeEvidence& evidence, const AliasGuardOptions& options) {
  return edge.verification.log10_false_alarms <= options.max_log10_false_alarms &&
         evidence.matched_share >= options.min_matched_share && evidence.shared_view >= options.min_shared_view &&
         evidence.spread >= options.min_spread;
}

bool is_peak(const WeighedEdge& edge, const EdgeEvidence& evidence, const AliasGuardOptions& options) {
  return static_cast<int>(edge.weight) >= options.min_peak_inliers &&
         evidence.matched_share >= options.min_peak_matched_share && evidence.rare_matches >= options.min_rare_matches;
}

}  // namespace

std::vector<GuardVerdict> guard_edges(const std::vector<MergeMember>& members, std::span<const Edge> inner_edges,
                                      std::span<const MergeEdge> inter_edges, const AppearanceSource& appearances,
                                      const AliasGuardOptions& options) {
  std::vector<GuardVerdict> verdicts(inter_edges.size());
  if (inter_edges.empty()) return verdicts;
  const InnerLinks links = inner_links(members, inner_edges, appearances, options);
  const auto far_hops = static_cast<std::uint8_t>(options.far_hops);
  HopBalls balls(members, links.along_drive, far_hops);
  const auto member_of = member_of_vertex(members, balls.vertices());

  // The pair by itself.
  std::vector<std::uint32_t> considered;  // edges that show enough: everything below is about these
  std::vector<const MergeEdge*> edges;
  std::vector<WeighedEdge> weighed;
  for (std::uint32_t e = 0; e < inter_edges.size(); ++e) {
    const MergeEdge& edge = inter_edges[e];
    require_between_members(edge, member_of);
    const EdgeOverlap overlap = edge_overlap(*appearances.appearances(edge.u), *appearances.appearances(edge.v),
                                             edge.verification.inlier_matches);
    EdgeEvidence& evidence = verdicts[e].evidence;
    evidence.matched_share = overlap.matched_share;
    evidence.shared_view = overlap.shared_view;
    evidence.spread = overlap.spread;
    if (!pair_shows_enough(edge, evidence, options)) {
      verdicts[e].reason = Reason::kUnsupported;
      continue;
    }
    considered.push_back(e);
    edges.push_back(&edge);
    weighed.push_back({edge.u, edge.v, static_cast<std::uint32_t>(std::max(1, edge.verification.inliers))});
  }
  if (considered.empty()) return verdicts;

  // Clusters that show their place somewhere.
  EdgeRelations relations(weighed, member_of, balls, options.near_hops);
  const auto cluster_of = relations.clusters(options.link_hops);
  const auto bonds = relations.bonds(cluster_of);
  const std::uint32_t clusters = *std::ranges::max_element(cluster_of) + 1;
  const auto rare = rare_matches(edges, appearances, WordPlaces(appearances, members), member_of, balls);
  std::vector<bool> has_peak(clusters, false), out(clusters, true);
  std::vector<std::uint32_t> sizes(clusters, 0);
  for (std::size_t k = 0; k < considered.size(); ++k) {
    EdgeEvidence& evidence = verdicts[considered[k]].evidence;
    evidence.rare_matches = rare[k];
    ++sizes[cluster_of[k]];
    if (is_peak(weighed[k], evidence, options)) has_peak[cluster_of[k]] = true;
  }
  for (const ClusterBond& b : bonds) {
    if (b.support > 0 && has_peak[b.from]) out[b.of] = false;
  }

  // Clusters against each other.
  HopBalls lenient_balls(members, links.with_revisits, far_hops);
  const auto lenient_bonds =
      links.with_revisits.size() == links.along_drive.size()
          ? bonds
          : EdgeRelations(weighed, member_of, lenient_balls, options.near_hops).bonds(cluster_of);
  const auto standings = contest(weighed, cluster_of, out, bonds, lenient_bonds,
                                 {options.dropped_beyond, options.ambiguous_beyond, options.duel_significance});
  for (std::size_t k = 0; k < considered.size(); ++k) {
    const ClusterStanding& standing = standings[cluster_of[k]];
    GuardVerdict& verdict = verdicts[considered[k]];
    verdict.reason = standing.reason;
    verdict.evidence.cluster_edges = sizes[cluster_of[k]];
    verdict.evidence.support = standing.support;
    verdict.evidence.contradiction = standing.contradiction;
  }
  return verdicts;
}

}  // namespace mapweld
