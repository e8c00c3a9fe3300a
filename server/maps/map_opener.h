// From a map's row to what localization reads of it.
#pragma once

#include <map>
#include <memory>
#include <mutex>

#include "schema/maps/map_layout.h"
#include "schema/maps/map_store.h"
#include "schema/store.h"
#include "server/maps/map_cache.h"
#include "server/maps/map_snapshot.h"

namespace mapweld::server {

// Changes whenever what the map shows does: a plain map's revision; of a merged map the sum over all merged maps that
// it is made of, and how often the edges of the plain ones were judged: what these gain beyond their watermarks does
// not show.
std::uint64_t shown_revision(const Reader& db, const MapLayout& layout);

// Thread-safe.
class MapOpener {
 public:
  // `store` and `cache` must outlive this.
  MapOpener(Store& store, MapCache& cache) : store_(store), cache_(cache) {}

  // The map of this layout as `db` sees it: with members in memory where they fit (large ones once they have been read,
  // from the store meanwhile), and the inter edges that its merge has found so far. Throws std::out_of_range when the
  // map, or a member, is gone.
  std::unique_ptr<MapSnapshot> open(const Reader& db, const MapLayout& layout);

  // A map was deleted.
  void forget(MapId map);

 private:
  std::shared_ptr<const LeafSource> open_leaf(const Reader& db, MapId leaf);
  std::shared_ptr<const InterEdges> inter_edges(const Reader& db, const MapLayout& layout);

  Store& store_;
  MapCache& cache_;

  struct CachedInter {
    std::uint64_t revision = 0;  // shown_revision
    std::shared_ptr<const InterEdges> edges;
  };
  std::mutex mutex_;
  std::map<MapId, CachedInter> inter_;
};

}  // namespace mapweld::server
