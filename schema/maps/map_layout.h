// How the vertices of a map are numbered, seen through all levels of merging.
//
// A merged map numbers the vertices of its members in spans: first each member up to its watermark, in the order given;
// later, when members have grown, what they gained. A member may itself be merged. A layout is that tree, flattened,
// read once: a value, good for one state of the database.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "schema/maps/map_store.h"
#include "schema/store.h"

namespace mapweld {

// Vertices [first, first + count) of the map are the vertices [node_first, node_first + count) of a node.
struct LayoutSpan {
  VertexId first{};
  VertexId node_first{};
  std::uint32_t count = 0;
  friend bool operator==(const LayoutSpan&, const LayoutSpan&) = default;
};

// A map in the tree: the map itself, its members, their members, ...
struct LayoutNode {
  MapId map{};
  MapKind kind = MapKind::kMap;
  std::uint32_t watermark = 0;    // vertices [0, watermark) of this node show through
  std::vector<LayoutSpan> spans;  // ascending by `first` and by `node_first`; together they cover [0, watermark)
  // The map's number of a vertex of this node, nullopt beyond the watermark.
  std::optional<VertexId> number(VertexId node_vertex) const;
  // The other way: this node's number of a vertex of the map, nullopt when it belongs to other nodes.
  std::optional<VertexId> node_vertex(VertexId vertex) const;
};

// Where a vertex really lives: a plain map and its number there.
struct LeafVertex {
  MapId map{};
  VertexId vertex{};
  friend bool operator==(const LeafVertex&, const LeafVertex&) = default;
};

class MapLayout {
 public:
  struct LeafSpan {
    VertexId first{};  // number in the map
    MapId leaf{};
    VertexId leaf_first{};  // number in the leaf
    std::uint32_t count = 0;
  };

  MapId map() const { return nodes_.front().map; }
  std::uint32_t vertices() const { return nodes_.front().watermark; }
  // The whole tree in depth-first order: the map itself first. A plain map is its only node.
  const std::vector<LayoutNode>& nodes() const { return nodes_; }
  // The plain maps' pieces, ascending, without gaps: [0, vertices()).
  const std::vector<LeafSpan>& leaf_spans() const { return leaf_spans_; }
  // Throws std::out_of_range for a number beyond vertices().
  LeafVertex leaf(VertexId vertex) const;

 private:
  friend MapLayout load_layout(const Reader& db, MapId map);
  std::vector<LayoutNode> nodes_;
  std::vector<LeafSpan> leaf_spans_;
};

// Throws std::out_of_range when there is no such map, StoreError kCorrupt when the tree is damaged.
MapLayout load_layout(const Reader& db, MapId map);

}  // namespace mapweld
