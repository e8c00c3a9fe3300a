#include "core/merge/hop_balls.h"

#include <algorithm>

namespace mapweld {

HopBalls::HopBalls(const std::vector<MergeMember>& members, std::span<const Edge> inner_edges, std::uint8_t radius)
    : radius_(radius) {
  std::uint32_t vertices = 0;
  for (const MergeMember& member : members) {
    for (const VertexId v : member.vertices) vertices = std::max(vertices, to_index(v) + 1);
  }
  const auto for_each_link = [&](const auto& use) {
    for (const Edge& e : inner_edges) use(to_index(e.u), to_index(e.v));
    for (const MergeMember& member : members) {
      for (std::size_t i = 1; i < member.vertices.size(); ++i) {
        use(to_index(member.vertices[i - 1]), to_index(member.vertices[i]));
      }
    }
  };
  offsets_.assign(vertices + 1, 0);
  for_each_link([&](std::uint32_t u, std::uint32_t v) {
    ++offsets_.at(u + 1);
    ++offsets_.at(v + 1);
  });
  for (std::uint32_t v = 0; v < vertices; ++v) offsets_[v + 1] += offsets_[v];
  neighbours_.resize(offsets_.back());
  std::vector<std::uint32_t> next(offsets_.begin(), offsets_.end() - 1);
  for_each_link([&](std::uint32_t u, std::uint32_t v) {
    neighbours_[next[u]++] = v;
    neighbours_[next[v]++] = u;
  });
  balls_.resize(vertices);
  visited_.assign(vertices, 0);
}

std::span<const ReachedVertex> HopBalls::around(VertexId centre) {
  std::vector<ReachedVertex>& ball = balls_.at(to_index(centre));
  if (!ball.empty()) return ball;
  ++stamp_;
  ball.push_back({to_index(centre), 0});
  visited_[to_index(centre)] = stamp_;
  for (std::size_t i = 0; i < ball.size(); ++i) {
    const ReachedVertex from = ball[i];
    if (from.hops == radius_) break;
    for (std::uint32_t k = offsets_[from.vertex]; k < offsets_[from.vertex + 1]; ++k) {
      const std::uint32_t to = neighbours_[k];
      if (visited_[to] == stamp_) continue;
      visited_[to] = stamp_;
      ball.push_back({to, static_cast<std::uint8_t>(from.hops + 1)});
    }
  }
  return ball;
}

}  // namespace mapweld
