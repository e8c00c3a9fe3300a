#include "core/merge/alias_guard.h"

#include <algorithm>
#include <map>
#include <stdexcept>
#include <unordered_map>
#include <utility>

#include "core/merge/cluster_contest.h"
#include "core/merge/drive_links.h"
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

void require_between_members(const MergeEdge& edge, const std::vector<std::uint32_t>& member_of) {
  const auto member = [&](VertexId v) { return to_index(v) < member_of.size() ? member_of[to_index(v)] : kNoMember; };
  if (member(edge.u) == kNoMember || member(edge.v) == kNoMember || member(edge.u) == member(edge.v)) {
    throw std::invalid_argument("an inter-map edge joins two members");
  }
}

bool pair_shows_enough(const MergeEdge& edge, const GuardEvidence& evidence, double min_matched_share,
                       const AliasGuardOptions& options) {
  return edge.verification.log10_false_alarms <= options.max_log10_false_alarms &&
         evidence.matched_share >= min_matched_share && evidence.shared_view >= options.min_shared_view &&
         evidence.spread >= options.min_spread &&
         // Evenly strewn over a rectangle, points lie sqrt(1 / 12) diagonals from its centre (root mean square).
         12 * evidence.spread * evidence.spread >= options.min_evenness * options.min_evenness * evidence.shared_view;
}

using MembersPair = std::pair<std::uint32_t, std::uint32_t>;
MembersPair pair_of(const MergeEdge& edge, const std::vector<std::uint32_t>& member_of) {
  return std::minmax(member_of[to_index(edge.u)], member_of[to_index(edge.v)]);
}

// What matched share an edge between two members needs.
std::map<MembersPair, double> needed_matched_share(std::span<const MergeEdge> edges,
                                                   const std::vector<GuardVerdict>& verdicts,
                                                   const std::vector<std::uint32_t>& member_of,
                                                   const AliasGuardOptions& options) {
  std::map<MembersPair, std::vector<double>> shares;
  for (std::size_t e = 0; e < edges.size(); ++e) {
    auto& of_pair = shares[pair_of(edges[e], member_of)];
    if (edges[e].verification.inliers >= options.min_peak_inliers) {
      of_pair.push_back(verdicts[e].evidence.matched_share);
    }
  }
  std::map<MembersPair, double> needed;
  for (auto& [pair, of_pair] : shares) {
    needed[pair] = options.min_matched_share;
    if (of_pair.empty()) continue;
    const auto best = of_pair.begin() + static_cast<std::ptrdiff_t>(of_pair.size() * 9 / 10);
    std::ranges::nth_element(of_pair, best);
    needed[pair] = std::min(needed[pair], options.matched_share_of_best * *best);
  }
  return needed;
}

bool is_peak(const WeighedEdge& edge, const GuardEvidence& evidence, std::uint32_t extent,
             const AliasGuardOptions& options) {
  return static_cast<int>(edge.weight) >= options.min_peak_inliers &&
         evidence.rare_matches >= options.min_rare_matches &&
         ((evidence.matched_share >= options.min_peak_matched_share &&
           edge.weight * evidence.matched_share >= options.min_peak_fullness) ||
          evidence.rare_matches >= options.min_peak_rare_matches || extent >= options.min_extent);
}

// How many vertices of either map each cluster joins; the smaller number.
std::vector<std::uint32_t> extents(std::span<const WeighedEdge> edges, std::span<const std::uint32_t> cluster_of,
                                   std::uint32_t clusters, const std::vector<std::uint32_t>& member_of) {
  std::vector<std::pair<std::uint32_t, std::uint32_t>> low, high;  // cluster, vertex of the member of lower number
  for (std::size_t e = 0; e < edges.size(); ++e) {
    std::uint32_t u = to_index(edges[e].u), v = to_index(edges[e].v);
    if (member_of[u] > member_of[v]) std::swap(u, v);
    low.emplace_back(cluster_of[e], u);
    high.emplace_back(cluster_of[e], v);
  }
  std::vector<std::uint32_t> extent(clusters, 0), other(clusters, 0);
  for (auto* list : {&low, &high}) {
    std::ranges::sort(*list);
    list->erase(std::ranges::unique(*list).begin(), list->end());
    for (const auto& [cluster, vertex] : *list) ++(list == &low ? extent : other)[cluster];
  }
  for (std::uint32_t c = 0; c < clusters; ++c) extent[c] = std::min(extent[c], other[c]);
  return extent;
}

}  // namespace

struct AliasGuard::Parts {
  Parts(std::vector<MergeMember> given, std::span<const Edge> inner_edges, const AppearanceSource& source,
        const AliasGuardOptions& chosen)
      : members(std::move(given)),
        appearances(source),
        options(chosen),
        balls(members,
              drive_links(members, inner_edges, source,
                          {chosen.longest_link, chosen.revisit_fullness, chosen.revisit_completeness,
                           chosen.min_revisit_images}),
              static_cast<std::uint8_t>(chosen.far_hops)),
        member_of(member_of_vertex(members, balls.vertices())),
        places(source, members) {}

  const EdgeOverlap& overlap(const MergeEdge& edge) {
    const auto [found, is_new] = overlaps.try_emplace(std::uint64_t{to_index(edge.u)} << 32 | to_index(edge.v));
    if (is_new) {
      found->second = edge_overlap(*appearances.appearances(edge.u), *appearances.appearances(edge.v),
                                   edge.verification.inlier_matches);
    }
    return found->second;
  }

  std::vector<MergeMember> members;
  const AppearanceSource& appearances;
  AliasGuardOptions options;
  HopBalls balls;
  std::vector<std::uint32_t> member_of;
  WordPlaces places;
  std::unordered_map<std::uint64_t, EdgeOverlap> overlaps;
};

AliasGuard::AliasGuard(std::vector<MergeMember> members, std::span<const Edge> inner_edges,
                       const AppearanceSource& appearances, const AliasGuardOptions& options)
    : parts_(std::make_unique<Parts>(std::move(members), inner_edges, appearances, options)) {}
AliasGuard::~AliasGuard() = default;
AliasGuard::AliasGuard(AliasGuard&&) noexcept = default;

std::vector<GuardVerdict> AliasGuard::verdicts(std::span<const MergeEdge> inter_edges) {
  std::vector<GuardVerdict> verdicts(inter_edges.size());
  if (inter_edges.empty()) return verdicts;
  const AliasGuardOptions& options = parts_->options;
  const auto& member_of = parts_->member_of;
  HopBalls& balls = parts_->balls;

  // The pair by itself.
  std::vector<std::uint32_t> considered;  // edges that show enough: everything below is about these
  std::vector<const MergeEdge*> edges;
  std::vector<WeighedEdge> weighed;
  for (std::uint32_t e = 0; e < inter_edges.size(); ++e) {
    const MergeEdge& edge = inter_edges[e];
    require_between_members(edge, member_of);
    const EdgeOverlap& overlap = parts_->overlap(edge);
    GuardEvidence& evidence = verdicts[e].evidence;
    evidence.matched_share = overlap.matched_share;
    evidence.shared_view = overlap.shared_view;
    evidence.spread = overlap.spread;
  }
  const auto needed = needed_matched_share(inter_edges, verdicts, member_of, options);
  for (std::uint32_t e = 0; e < inter_edges.size(); ++e) {
    const MergeEdge& edge = inter_edges[e];
    if (!pair_shows_enough(edge, verdicts[e].evidence, needed.at(pair_of(edge, member_of)), options)) {
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
  const auto rare = rare_matches(edges, parts_->appearances, parts_->places, member_of, balls);
  std::vector<bool> has_peak(clusters, false), has_rare(clusters, false), out(clusters, true);
  std::vector<std::uint32_t> sizes(clusters, 0);
  const auto extent = extents(weighed, cluster_of, clusters, member_of);
  for (std::size_t k = 0; k < considered.size(); ++k) {
    GuardEvidence& evidence = verdicts[considered[k]].evidence;
    evidence.rare_matches = rare[k];
    ++sizes[cluster_of[k]];
    if (evidence.rare_matches >= options.min_rare_matches) has_rare[cluster_of[k]] = true;
    if (is_peak(weighed[k], evidence, extent[cluster_of[k]], options)) has_peak[cluster_of[k]] = true;
  }
  for (const ClusterBond& b : bonds) {
    if (b.support > 0 && has_peak[b.from] && has_rare[b.of]) out[b.of] = false;
  }

  // Clusters against each other.
  const auto standings = contest(weighed, cluster_of, out, bonds,
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

std::vector<GuardVerdict> guard_edges(const std::vector<MergeMember>& members, std::span<const Edge> inner_edges,
                                      std::span<const MergeEdge> inter_edges, const AppearanceSource& appearances,
                                      const AliasGuardOptions& options) {
  return AliasGuard(members, inner_edges, appearances, options).verdicts(inter_edges);
}

}  // namespace mapweld
