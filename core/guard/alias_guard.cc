#include "core/guard/alias_guard.h"

#include <algorithm>
#include <exception>
#include <optional>
#include <stdexcept>
#include <utility>
#include <vector>

#include "core/guard/beliefs.h"
#include "core/guard/edge_fullness.h"
#include "core/guard/guarded_map.h"

namespace mapweld {
namespace {

constexpr std::uint32_t kNoMember = 0xFFFFFFFF;

// Where a merged vertex stands in its member.
struct Place {
  std::uint32_t member = kNoMember;
  std::uint32_t own = 0;
};

std::vector<Place> places_of(const std::vector<MergeMember>& members) {
  std::vector<Place> places;
  for (std::uint32_t m = 0; m < members.size(); ++m) {
    for (std::uint32_t i = 0; i < members[m].vertices.size(); ++i) {
      const std::uint32_t v = to_index(members[m].vertices[i]);
      if (v >= places.size()) places.resize(v + 1);
      places[v] = {m, i};
    }
  }
  return places;
}

void append_links(const LinkLists& own, const std::vector<VertexId>& vertices, LinkLists& merged) {
  for (std::uint32_t v = 0; v < own.size(); ++v) {
    for (const Link& link : own[v]) merged[to_index(vertices[v])].push_back({to_index(vertices[link.to]), link.belief});
  }
}

}  // namespace

struct AliasGuard::Parts {
  Parts(const std::vector<MergeMember>& members, std::span<const VerifiedEdge> inner_edges,
        const AppearanceSource& source, const GuardOptions& chosen, const Executor* executor)
      : appearances(source),
        options(chosen),
        places(places_of(members)),
        around(places.size()),
        passing(places.size()) {
    std::vector<std::vector<VerifiedEdge>> own(members.size());
    std::vector<std::vector<std::size_t>> numbers(members.size());
    for (std::size_t e = 0; e < inner_edges.size(); ++e) {
      const Place u = place(inner_edges[e].u), v = place(inner_edges[e].v);
      if (u.member == kNoMember || u.member != v.member) throw std::invalid_argument("an inner edge is of one member");
      own[u.member].push_back({VertexId{u.own}, VertexId{v.own}, inner_edges[e].inlier_matches});
      numbers[u.member].push_back(e);
    }
    make_maps(members, own, executor);
    inner_verdicts.resize(inner_edges.size());
    for (std::size_t m = 0; m < members.size(); ++m) {
      const std::vector<VertexId>& vertices = members[m].vertices;
      for (std::size_t k = 0; k < own[m].size(); ++k) inner_verdicts[numbers[m][k]] = maps[m].verdicts()[k];
      append_links(maps[m].around(), vertices, around);
      append_links(maps[m].passing(), vertices, passing);
    }
    beliefs.emplace(around, passing, options.model, false);
  }

  void make_maps(const std::vector<MergeMember>& members, const std::vector<std::vector<VerifiedEdge>>& own,
                 const Executor* executor) {
    std::vector<std::optional<GuardedMap>> made(members.size());
    std::vector<std::exception_ptr> failed(members.size());
    run_pieces(executor, members.size(), [&](std::size_t m) {
      const std::vector<VertexId>& vertices = members[m].vertices;
      const auto image = [&](std::uint32_t v) { return appearances.appearances(vertices[v]); };
      try {
        made[m].emplace(static_cast<std::uint32_t>(vertices.size()), image, own[m], options, executor);
      } catch (...) {
        failed[m] = std::current_exception();
      }
    });
    for (std::size_t m = 0; m < members.size(); ++m) {
      if (failed[m]) std::rethrow_exception(failed[m]);
      maps.push_back(std::move(*made[m]));
    }
  }

  Place place(VertexId v) const { return to_index(v) < places.size() ? places[to_index(v)] : Place{}; }

  void add(const MergeEdge& edge) {
    const Place u = place(edge.u), v = place(edge.v);
    if (u.member == kNoMember || v.member == kNoMember || u.member == v.member) {
      throw std::invalid_argument("an inter-map edge joins two members");
    }
    GuardedMap& of_u = maps[u.member];
    GuardedMap& of_v = maps[v.member];
    const VerifiedEdge verified{edge.u, edge.v, edge.verification.inlier_matches};
    EdgeSigns signs;
    signs.fullness = edge_fullness(*appearances.appearances(edge.u), *appearances.appearances(edge.v), verified);
    signs.rare_matches = of_u.rarity().rare_matches(u.own, of_v.rarity(), v.own, verified);
    signs.far_images = std::min(of_u.rarity().far_images(u.own), of_v.rarity().far_images(v.own));
    signs.common_share = std::max(of_u.rarity().common_share(u.own), of_v.rarity().common_share(v.own));
    signs.inner_fullness = std::min(of_u.fullness(u.own), of_v.fullness(v.own));
    beliefs->add(to_index(edge.u), to_index(edge.v), signs);
    judged.emplace_back(edge.u, edge.v);
  }

  bool goes_on_from_judged(std::span<const MergeEdge> edges) const {
    return edges.size() >= judged.size() &&
           std::equal(judged.begin(), judged.end(), edges.begin(),
                      [](const auto& ends, const MergeEdge& e) { return ends == std::pair(e.u, e.v); });
  }

  const AppearanceSource& appearances;
  GuardOptions options;
  std::vector<Place> places;     // by merged vertex
  LinkLists around, passing;     // of the members, merged numbers
  std::vector<GuardedMap> maps;  // by member
  std::vector<GuardVerdict> inner_verdicts;
  std::optional<Beliefs> beliefs;
  std::vector<std::pair<VertexId, VertexId>> judged;  // the edges that beliefs are about
  std::vector<GuardVerdict> verdicts;
};

AliasGuard::AliasGuard(std::vector<MergeMember> members, std::span<const VerifiedEdge> inner_edges,
                       const AppearanceSource& appearances, const GuardOptions& options, const Executor* executor)
    : parts_(std::make_unique<Parts>(members, inner_edges, appearances, options, executor)) {}
AliasGuard::~AliasGuard() = default;
AliasGuard::AliasGuard(AliasGuard&&) noexcept = default;

const std::vector<GuardVerdict>& AliasGuard::inner_verdicts() const { return parts_->inner_verdicts; }

const std::vector<GuardVerdict>& AliasGuard::verdicts(std::span<const MergeEdge> inter_edges) {
  Parts& parts = *parts_;
  if (!parts.goes_on_from_judged(inter_edges)) {
    parts.judged.clear();
    parts.beliefs.emplace(parts.around, parts.passing, parts.options.model, false);
  }
  const std::size_t before = parts.judged.size();
  for (const MergeEdge& edge : inter_edges.subspan(before)) parts.add(edge);
  if (parts.judged.size() != before || parts.verdicts.size() != inter_edges.size()) {
    parts.beliefs->settle();
    parts.verdicts.clear();
    for (std::uint32_t e = 0; e < inter_edges.size(); ++e) {
      parts.verdicts.push_back(verdict_of(parts.beliefs->signs(e), parts.beliefs->belief(e), parts.options, false));
    }
  }
  return parts.verdicts;
}

std::vector<GuardVerdict> guard_edges(const std::vector<MergeMember>& members,
                                      std::span<const VerifiedEdge> inner_edges, std::span<const MergeEdge> inter_edges,
                                      const AppearanceSource& appearances, const GuardOptions& options) {
  return AliasGuard(members, inner_edges, appearances, options).verdicts(inter_edges);
}

std::vector<Edge> confirmed_edges(std::span<const VerifiedEdge> edges, std::span<const GuardVerdict> verdicts) {
  std::vector<Edge> confirmed;
  for (std::size_t e = 0; e < edges.size(); ++e) {
    if (!verdicts[e].confirmed()) continue;
    confirmed.push_back({edges[e].u, edges[e].v, static_cast<std::uint32_t>(edges[e].inlier_matches.size())});
  }
  return confirmed;
}

}  // namespace mapweld
