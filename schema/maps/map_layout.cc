#include "schema/maps/map_layout.h"

#include <algorithm>
#include <stdexcept>
#include <string>

namespace mapweld {
namespace {

VertexId plus(VertexId vertex, std::uint32_t count) { return VertexId{to_index(vertex) + count}; }

struct MemberSpan {
  MapId member{};
  std::uint32_t first = 0;         // in the merged map
  std::uint32_t first_member = 0;  // in the member
  std::uint32_t count = 0;
};

std::vector<MemberSpan> read_spans(const Reader& db, MapId merged) {
  sqlite::Statement row = db.prepare(
      "SELECT member, first_vertex, first_member_vertex, count FROM member_spans WHERE merged = ? ORDER BY span");
  row.bind(1, merged);
  std::vector<MemberSpan> spans;
  while (row.step()) {
    spans.push_back({row.id<MapId>(0), static_cast<std::uint32_t>(row.integer(1)),
                     static_cast<std::uint32_t>(row.integer(2)), static_cast<std::uint32_t>(row.integer(3))});
  }
  return spans;
}

MapRow require_map(const Reader& db, MapId map) {
  auto row = find_map(db, map);
  if (!row) throw std::out_of_range("there is no map " + std::to_string(to_index(map)));
  return *row;
}

// The part of a member's span that a node's own spans show, in the numbering of the top.
void append_visible(const LayoutNode& node, const MemberSpan& span, LayoutNode& child) {
  for (const LayoutSpan& shown : node.spans) {
    const std::uint32_t node_first = to_index(shown.node_first);
    const std::uint32_t begin = std::max(node_first, span.first);
    const std::uint32_t end = std::min(node_first + shown.count, span.first + span.count);
    if (begin >= end) continue;
    child.spans.push_back(
        {plus(shown.first, begin - node_first), VertexId{span.first_member + (begin - span.first)}, end - begin});
    child.watermark += end - begin;
  }
}

void append_node(const Reader& db, LayoutNode node, std::vector<LayoutNode>& nodes) {
  const std::size_t at = nodes.size();
  nodes.push_back(std::move(node));
  if (nodes[at].kind == MapKind::kMap) return;
  const std::vector<MemberSpan> spans = read_spans(db, nodes[at].map);
  std::vector<MapId> members;
  for (const MemberSpan& span : spans) {
    if (std::ranges::find(members, span.member) == members.end()) members.push_back(span.member);
  }
  for (const MapId member : members) {
    // A map is made after its members: only damage could close a circle.
    if (member >= nodes[at].map) {
      throw StoreError(StoreErrorKind::kCorrupt, "map " + std::to_string(to_index(nodes[at].map)) +
                                                     " has the younger map " + std::to_string(to_index(member)) +
                                                     " as a member");
    }
    LayoutNode child;
    child.map = member;
    child.kind = require_map(db, member).kind;
    for (const MemberSpan& span : spans) {
      if (span.member == member) append_visible(nodes[at], span, child);
    }
    append_node(db, std::move(child), nodes);
  }
}

}  // namespace

std::optional<VertexId> LayoutNode::number(VertexId node_vertex) const {
  auto span = std::ranges::upper_bound(spans, node_vertex, {}, &LayoutSpan::node_first);
  if (span == spans.begin()) return std::nullopt;
  --span;
  const std::uint32_t offset = to_index(node_vertex) - to_index(span->node_first);
  if (offset >= span->count) return std::nullopt;
  return plus(span->first, offset);
}

std::optional<VertexId> LayoutNode::node_vertex(VertexId vertex) const {
  auto span = std::ranges::upper_bound(spans, vertex, {}, &LayoutSpan::first);
  if (span == spans.begin()) return std::nullopt;
  --span;
  const std::uint32_t offset = to_index(vertex) - to_index(span->first);
  if (offset >= span->count) return std::nullopt;
  return plus(span->node_first, offset);
}

LeafVertex MapLayout::leaf(VertexId vertex) const {
  if (to_index(vertex) >= vertices()) {
    throw std::out_of_range("the map has no vertex " + std::to_string(to_index(vertex)));
  }
  const auto span = std::prev(std::ranges::upper_bound(leaf_spans_, vertex, {}, &LeafSpan::first));
  return {span->leaf, plus(span->leaf_first, to_index(vertex) - to_index(span->first))};
}

MapLayout load_layout(const Reader& db, MapId map) {
  const MapRow row = require_map(db, map);
  MapLayout layout;
  LayoutNode root{map, row.kind, row.vertices, {}};
  if (row.vertices > 0) root.spans.push_back({VertexId{0}, VertexId{0}, row.vertices});
  append_node(db, std::move(root), layout.nodes_);
  for (const LayoutNode& node : layout.nodes_) {
    if (node.kind != MapKind::kMap) continue;
    for (const LayoutSpan& span : node.spans) {
      layout.leaf_spans_.push_back({span.first, node.map, span.node_first, span.count});
    }
  }
  std::ranges::sort(layout.leaf_spans_, {}, &MapLayout::LeafSpan::first);
  return layout;
}

}  // namespace mapweld
