// What a plain map's own images say of its edges, written down.
#pragma once

#include <cstddef>

#include "schema/maps/map_store.h"
#include "schema/store.h"
#include "server/maps/map_cache.h"

namespace mapweld::server {

struct JudgeStatistics {
  std::size_t edges = 0;    // that were judged
  std::size_t changed = 0;  // of them, of which is thought otherwise than is written
};

// Judges all inner edges of a plain map by core/guard/guarded_map.h, as it is at this moment, and writes what changed
// in one transaction; the map in memory follows. Images that come meanwhile, and their edges, stay unjudged until the
// next time. Loop closures are judged anew with the rest: what came since can confirm an old one, and the other way
// round. Takes as much memory as the appearances of the map, and its writer's turn at the end only. Nothing happens to
// a map that was deleted meanwhile. Throws StoreError.
JudgeStatistics judge_map(Store& store, MapCache& cache, const MapRow& map);

}  // namespace mapweld::server
