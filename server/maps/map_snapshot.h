// A map, plain or merged, as localization reads it: what it showed at one moment, whatever is added meanwhile.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "core/mapping/localizer.h"
#include "schema/maps/map_layout.h"
#include "server/maps/leaf_source.h"

namespace mapweld::server {

// Inter-map edges of a merged map, all levels of merging, in its numbering.
struct InterEdges {
  std::vector<std::vector<VertexId>> neighbours;  // by vertex
};

// A view over the plain maps that a map is made of: nothing is copied, and nothing of a member shows beyond its
// watermark. Thread-safe as its sources are.
class MapSnapshot final : public MapView, private PostingSource {
 public:
  // `leaves[i]` is where the layout's leaf span i is read from. `inter` may be null.
  MapSnapshot(const MapLayout& layout, std::vector<std::shared_ptr<const LeafSource>> leaves,
              std::shared_ptr<const InterEdges> inter);

  // A plain map of `vertices` vertices.
  MapSnapshot(MapId map, std::uint32_t vertices, std::shared_ptr<const LeafSource> leaf);

  const PostingSource& postings() const override { return *this; }
  std::shared_ptr<const AppearanceVector> appearances(VertexId vertex) const override;
  std::optional<int> hops(VertexId u, VertexId v, int at_most) const override;
  // Of inter edges, the confirmed ones.
  std::vector<VertexId> linked(VertexId vertex) const override;

 private:
  struct Span {
    std::uint32_t first = 0;
    MapId leaf_map{};
    std::uint32_t leaf_first = 0;
    std::uint32_t count = 0;
    std::shared_ptr<const LeafSource> leaf;
  };

  void visit(WordId word, const Visitor& visitor) const override;
  std::uint32_t vertices() const override { return vertices_; }

  const Span& span_of(VertexId vertex) const;
  using Inner = void (LeafSource::*)(VertexId, std::vector<VertexId>&) const;  // of the edges of a leaf, which ones
  void neighbours(VertexId vertex, Inner inner_of, std::vector<VertexId>& out) const;

  std::vector<Span> spans_;  // ascending by `first`, without gaps
  std::uint32_t vertices_ = 0;
  std::shared_ptr<const InterEdges> inter_;
};

}  // namespace mapweld::server
