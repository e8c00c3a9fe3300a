#include "server/maps/map_opener.h"

#include <stdexcept>
#include <utility>

#include "schema/maps/edge_store.h"
#include "server/maps/map_settings.h"
#include "server/maps/stored_map.h"

namespace mapweld::server {

std::uint64_t shown_revision(const Reader& db, const MapLayout& layout) {
  const bool merged = layout.nodes().front().kind == MapKind::kMerged;
  std::uint64_t revision = 0;
  for (const LayoutNode& node : layout.nodes()) {
    const std::optional<MapRow> row = find_map(db, node.map);
    if (!row) continue;
    revision += merged && node.kind != MapKind::kMerged ? row->judgements : row->revision;
  }
  return revision;
}

std::unique_ptr<MapSnapshot> MapOpener::open(const Reader& db, const MapLayout& layout) {
  std::map<MapId, std::shared_ptr<const LeafSource>> opened;
  std::vector<std::shared_ptr<const LeafSource>> leaves;
  for (const MapLayout::LeafSpan& span : layout.leaf_spans()) {
    auto& leaf = opened[span.leaf];
    if (!leaf) leaf = open_leaf(db, span.leaf);
    leaves.push_back(leaf);
  }
  const bool merged = layout.nodes().front().kind == MapKind::kMerged;
  return std::make_unique<MapSnapshot>(layout, std::move(leaves), merged ? inter_edges(db, layout) : nullptr);
}

std::shared_ptr<const LeafSource> MapOpener::open_leaf(const Reader& db, MapId leaf) {
  const std::optional<MapRow> row = find_map(db, leaf);
  if (!row) throw std::out_of_range("a member was deleted");
  if (auto loaded = cache_.open_unless_long(*row, settings_of(*row).parameters.max_features)) return loaded;
  return std::make_shared<StoredMap>(store_, leaf, row->vocabulary);
}

std::shared_ptr<const InterEdges> MapOpener::inter_edges(const Reader& db, const MapLayout& layout) {
  const std::uint64_t revision = shown_revision(db, layout);
  {
    const std::lock_guard lock(mutex_);
    const auto found = inter_.find(layout.map());
    if (found != inter_.end() && found->second.revision == revision) return found->second.edges;
  }
  auto edges = std::make_shared<InterEdges>();
  edges->neighbours.resize(layout.vertices());
  for (const Edge& edge : load_edges(db, layout, {.inter = true, .confirmed = true})) {
    edges->neighbours[to_index(edge.u)].push_back(edge.v);
    edges->neighbours[to_index(edge.v)].push_back(edge.u);
  }
  const std::lock_guard lock(mutex_);
  CachedInter& cached = inter_[layout.map()];
  // A request with an older snapshot may finish later.
  if (!cached.edges || cached.revision < revision) cached = {revision, edges};
  return edges;
}

void MapOpener::forget(MapId map) {
  cache_.forget(map);
  const std::lock_guard lock(mutex_);
  inter_.erase(map);
}

}  // namespace mapweld::server
