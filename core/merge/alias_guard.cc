#include "core/merge/alias_guard.h"

#include <algorithm>
#include <numeric>
#include <stdexcept>

#include "core/merge/edge_overlap.h"
#include "core/merge/edge_relations.h"
#include "core/merge/hop_balls.h"
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

// The inner edges along the drive.
std::vector<Edge> links_of_drive(const std::vector<MergeMember>& members, std::span<const Edge> inner_edges,
                                 std::uint32_t longest_link) {
  std::vector<std::uint32_t> position;
  for (const MergeMember& member : members) {
    for (std::uint32_t i = 0; i < member.vertices.size(); ++i) {
      const std::uint32_t v = to_index(member.vertices[i]);
      if (v >= position.size()) position.resize(v + 1, 0);
      position[v] = i;
    }
  }
  std::vector<Edge> links;
  for (const Edge& e : inner_edges) {
    const std::uint32_t i = position.at(to_index(e.u)), j = position.at(to_index(e.v));
    if ((i < j ? j - i : i - j) <= longest_link) links.push_back(e);
  }
  return links;
}

void require_between_members(const MergeEdge& edge, const std::vector<std::uint32_t>& member_of) {
  const auto member = [&](VertexId v) { return to_index(v) < member_of.size() ? member_of[to_index(v)] : kNoMember; };
  if (member(edge.u) == kNoMember || member(edge.v) == kNoMember || member(edge.u) == member(edge.v)) {
    throw std::invalid_argument("an inter-map edge joins two members");
  }
}

// Marks the inliers whose word occurs far from the edge's end on one side.
class CommonWords {
 public:
  CommonWords(std::span<const MergeEdge> edges, const AppearanceSource& appearances, const WordPlaces& places,
              const std::vector<std::uint32_t>& member_of, HopBalls& balls)
      : edges_(edges), appearances_(appearances), places_(places), member_of_(member_of), balls_(balls) {}

  // The number of inliers of each edge whose word is rare at both ends.
  std::vector<int> rare_matches(std::span<const std::uint32_t> which) {
    is_common_.resize(edges_.size());
    for (const std::uint32_t e : which) is_common_[e].assign(edges_[e].verification.inlier_matches.size(), false);
    mark(true, which);
    mark(false, which);
    std::vector<int> rare(edges_.size(), 0);
    for (const std::uint32_t e : which) rare[e] = static_cast<int>(std::ranges::count(is_common_[e], false));
    return rare;
  }

 private:
  void mark(bool at_u, std::span<const std::uint32_t> which) {
    const auto end = [&](std::uint32_t e) { return at_u ? edges_[e].u : edges_[e].v; };
    std::vector<std::uint32_t> order(which.begin(), which.end());
    std::ranges::sort(order, {}, end);
    std::vector<bool> is_near(balls_.vertices(), false);
    for (std::size_t first = 0; first < order.size();) {
      const VertexId centre = end(order[first]);
      const std::uint32_t member = member_of_[to_index(centre)];
      const auto ball = balls_.around(centre);
      const auto image = appearances_.appearances(centre);
      for (const ReachedVertex& r : ball) is_near[r.vertex] = true;
      for (; first < order.size() && end(order[first]) == centre; ++first) {
        const std::uint32_t e = order[first];
        const auto& matches = edges_[e].verification.inlier_matches;
        for (std::size_t m = 0; m < matches.size(); ++m) {
          if (is_common_[e][m]) continue;
          const WordId word = image->appearances.at(at_u ? matches[m].first : matches[m].second).word;
          is_common_[e][m] = std::ranges::any_of(places_.vertices_with(word), [&](std::uint32_t vertex) {
            return member_of_[vertex] == member && !is_near[vertex];
          });
        }
      }
      for (const ReachedVertex& r : ball) is_near[r.vertex] = false;
    }
  }

  std::span<const MergeEdge> edges_;
  const AppearanceSource& appearances_;
  const WordPlaces& places_;
  const std::vector<std::uint32_t>& member_of_;
  HopBalls& balls_;
  std::vector<std::vector<bool>> is_common_;
};

bool pair_shows_enough(const MergeEdge& edge, const EdgeEvidence& evidence, const AliasGuardOptions& options) {
  return edge.verification.log10_false_alarms <= options.max_log10_false_alarms &&
         evidence.matched_share >= options.min_matched_share && evidence.shared_view >= options.min_shared_view &&
         evidence.spread >= options.min_spread;
}

bool outweighs(double times, const EdgeBalance& balance) {
  return static_cast<double>(balance.contradiction) > times * static_cast<double>(balance.support);
}

}  // namespace

std::vector<GuardVerdict> guard_edges(const std::vector<MergeMember>& members, std::span<const Edge> inner_edges,
                                      std::span<const MergeEdge> inter_edges, const AppearanceSource& appearances,
                                      const AliasGuardOptions& options) {
  std::vector<GuardVerdict> verdicts(inter_edges.size());
  if (inter_edges.empty()) return verdicts;
  HopBalls balls(members, links_of_drive(members, inner_edges, options.longest_link),
                 static_cast<std::uint8_t>(options.far_hops));
  const auto member_of = member_of_vertex(members, balls.vertices());

  // The pair by itself.
  std::vector<std::uint32_t> considered;
  for (std::uint32_t e = 0; e < inter_edges.size(); ++e) {
    const MergeEdge& edge = inter_edges[e];
    require_between_members(edge, member_of);
    const EdgeOverlap overlap = edge_overlap(*appearances.appearances(edge.u), *appearances.appearances(edge.v),
                                             edge.verification.inlier_matches);
    EdgeEvidence& evidence = verdicts[e].evidence;
    evidence.matched_share = overlap.matched_share;
    evidence.shared_view = overlap.shared_view;
    evidence.spread = overlap.spread;
    if (pair_shows_enough(edge, evidence, options)) {
      considered.push_back(e);
    } else {
      verdicts[e].reason = Reason::kUnsupported;
    }
  }

  // Words.
  const WordPlaces places(appearances, members);
  const auto rare = CommonWords(inter_edges, appearances, places, member_of, balls).rare_matches(considered);

  // The others.
  std::vector<WeighedEdge> weighed;
  for (const std::uint32_t e : considered) {
    verdicts[e].evidence.rare_matches = rare[e];
    const MergeEdge& edge = inter_edges[e];
    weighed.push_back({edge.u, edge.v, static_cast<std::uint32_t>(edge.verification.inliers)});
  }
  EdgeRelations relations(weighed, member_of, balls, options.near_hops);
  auto balances = relations.balances();
  std::vector<std::uint32_t> standing(weighed.size()), dropped;
  std::iota(standing.begin(), standing.end(), 0u);
  do {
    const auto stays = [&](std::uint32_t k) { return !outweighs(options.dropped_beyond, balances[k]); };
    const auto gone = std::stable_partition(standing.begin(), standing.end(), stays);
    dropped.assign(gone, standing.end());
    standing.erase(gone, standing.end());
    for (const std::uint32_t k : dropped) verdicts[considered[k]].reason = Reason::kUnsupported;
    relations.withdraw(dropped, balances);
  } while (!dropped.empty());
  for (std::uint32_t k = 0; k < weighed.size(); ++k) {
    EdgeEvidence& evidence = verdicts[considered[k]].evidence;
    evidence.support = balances[k].support;
    evidence.contradiction = balances[k].contradiction;
  }
  for (const std::uint32_t k : standing) {
    GuardVerdict& verdict = verdicts[considered[k]];
    if (outweighs(options.ambiguous_beyond, balances[k]) && verdict.evidence.rare_matches < options.min_rare_matches) {
      verdict.reason = Reason::kAmbiguous;
    }
  }
  return verdicts;
}

}  // namespace mapweld
