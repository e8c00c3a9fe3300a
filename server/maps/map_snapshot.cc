#include "server/maps/map_snapshot.h"

#include <algorithm>
#include <set>
#include <stdexcept>
#include <utility>

namespace mapweld::server {

MapSnapshot::MapSnapshot(const MapLayout& layout, std::vector<std::shared_ptr<const LeafSource>> leaves,
                         std::shared_ptr<const InterEdges> inter)
    : vertices_(layout.vertices()), inter_(std::move(inter)) {
  for (std::size_t i = 0; i < layout.leaf_spans().size(); ++i) {
    const MapLayout::LeafSpan& span = layout.leaf_spans()[i];
    spans_.push_back({to_index(span.first), span.leaf, to_index(span.leaf_first), span.count, std::move(leaves.at(i))});
  }
}

MapSnapshot::MapSnapshot(MapId map, std::uint32_t vertices, std::shared_ptr<const LeafSource> leaf)
    : vertices_(vertices) {
  spans_.push_back({0, map, 0, vertices, std::move(leaf)});
}

void MapSnapshot::visit(WordId word, const Visitor& visitor) const {
  for (const Span& span : spans_) {
    span.leaf->visit(word, VertexId{span.leaf_first}, VertexId{span.leaf_first + span.count},
                     [&visitor, shift = span.first - span.leaf_first](const PostingSpan& part) {
                       visitor({part, shift});
                     });
  }
}

const MapSnapshot::Span& MapSnapshot::span_of(VertexId vertex) const {
  if (to_index(vertex) >= vertices_) throw std::out_of_range("a vertex beyond the map");
  const auto after = std::upper_bound(spans_.begin(), spans_.end(), to_index(vertex),
                                      [](std::uint32_t v, const Span& span) { return v < span.first; });
  return *std::prev(after);
}

std::shared_ptr<const AppearanceVector> MapSnapshot::appearances(VertexId vertex) const {
  const Span& span = span_of(vertex);
  return span.leaf->appearances(VertexId{to_index(vertex) - span.first + span.leaf_first});
}

void MapSnapshot::neighbours(VertexId vertex, Inner inner_of, std::vector<VertexId>& out) const {
  const Span& own = span_of(vertex);
  std::vector<VertexId> inner;
  ((*own.leaf).*inner_of)(VertexId{to_index(vertex) - own.first + own.leaf_first}, inner);
  for (const VertexId neighbour : inner) {
    for (const Span& span : spans_) {
      const std::uint32_t offset = to_index(neighbour) - span.leaf_first;
      if (span.leaf_map != own.leaf_map || to_index(neighbour) < span.leaf_first || offset >= span.count) continue;
      out.push_back(VertexId{span.first + offset});
      break;
    }
  }
  if (inter_ && to_index(vertex) < inter_->neighbours.size()) {
    const auto& joined = inter_->neighbours[to_index(vertex)];
    out.insert(out.end(), joined.begin(), joined.end());
  }
}

std::vector<VertexId> MapSnapshot::linked(VertexId vertex) const {
  std::vector<VertexId> found;
  neighbours(vertex, &LeafSource::linked, found);
  return found;
}

std::optional<int> MapSnapshot::hops(VertexId u, VertexId v, int at_most) const {
  std::set<VertexId> seen = {u};
  std::vector<VertexId> front = {u};
  std::vector<VertexId> next;
  for (int hops = 0; hops <= at_most && !front.empty(); ++hops) {
    if (seen.contains(v)) return hops;
    if (hops == at_most) break;
    std::vector<VertexId> reached;
    for (const VertexId vertex : front) {
      next.clear();
      neighbours(vertex, &LeafSource::neighbours, next);
      for (const VertexId neighbour : next) {
        if (seen.insert(neighbour).second) reached.push_back(neighbour);
      }
    }
    front = std::move(reached);
  }
  return std::nullopt;
}

}  // namespace mapweld::server
