#include "core/merge/member_table.h"

#include <utility>

#include "core/graph/matching.h"

namespace mapweld {

std::string_view to_string(JoinVerdict verdict) {
  switch (verdict) {
    case JoinVerdict::kJoined:
      return "joined";
    case JoinVerdict::kNotJoined:
      return "not_joined";
    case JoinVerdict::kAmbiguous:
      return "ambiguous";
    case JoinVerdict::kUndecided:
      return "undecided";
  }
  return "";
}

std::vector<MemberPairSummary> member_table(const std::vector<MergeMember>& members, std::span<const MergeEdge> edges,
                                            std::span<const RejectedPair> rejected, const std::vector<bool>& confirmed,
                                            const std::vector<bool>& finished) {
  std::size_t vertices = 0;
  for (const MergeMember& member : members) vertices += member.vertices.size();
  std::vector<std::uint32_t> member_of(vertices);
  for (std::uint32_t k = 0; k < members.size(); ++k) {
    for (const VertexId v : members[k].vertices) member_of[to_index(v)] = k;
  }
  const std::size_t n = members.size();
  const auto place_of = [&](VertexId u, VertexId v) {
    return place_of_pair(member_of[to_index(u)], member_of[to_index(v)], n);
  };
  std::vector<MemberPairSummary> table;
  for (std::uint32_t i = 0; i < n; ++i) {
    for (std::uint32_t j = i + 1; j < n; ++j) table.push_back({.first = i, .second = j});
  }
  std::vector<std::vector<std::pair<VertexId, VertexId>>> joins(table.size());
  for (std::size_t e = 0; e < edges.size(); ++e) {
    const std::size_t place = place_of(edges[e].u, edges[e].v);
    ++table[place].verified;
    ++table[place].accepted;
    if (!confirmed.empty() && !confirmed[e]) continue;
    ++table[place].confirmed;
    joins[place].emplace_back(edges[e].u, edges[e].v);
  }
  for (const RejectedPair& r : rejected) ++table[place_of(r.source, r.target)].verified;
  for (std::size_t place = 0; place < table.size(); ++place) {
    MemberPairSummary& pair = table[place];
    pair.independent_joins = maximum_matching(joins[place]);
    pair.verdict = pair.confirmed > 0  ? JoinVerdict::kJoined
                   : pair.accepted > 0 ? JoinVerdict::kAmbiguous
                   : finished[place]   ? JoinVerdict::kNotJoined
                                       : JoinVerdict::kUndecided;
  }
  return table;
}

}  // namespace mapweld
