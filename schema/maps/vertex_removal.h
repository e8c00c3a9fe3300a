// Deleting vertices of plain maps, restoring them, and removing them for good.
//
// A deleted vertex has a tombstone, images.deleted_at_us. Nothing of it shows, in no map that is made of its own:
// readers of vertices pass over it, its edges of all levels of merging stand in `deleted_edges`, votes are not given to
// it. All of it comes back when it is restored. Its number stays its own for ever, its name until it is purged.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "schema/maps/map_store.h"
#include "schema/store.h"
#include "schema/store_types.h"

namespace mapweld {

enum class VertexStanding : std::uint8_t { kThere, kDeleted, kPurged, kNeverGiven };
// Of a plain map.
VertexStanding standing_of(const Reader& db, MapId map, VertexId vertex);

// Deletes those of the vertices [first, first + count) of a plain map that are there; returns how many. The revisions
// of the map and of all merged maps that show one of them grow. No merge over the map may be queued or running.
std::uint64_t delete_vertices(WriteTransaction& db, MapId map, VertexId first, std::uint64_t count, Timestamp now);

// Takes the tombstone away. Edges come back with their ids, those to other vertices that are still deleted with the
// last of the two. Revisions as above. False, and nothing changed, for a vertex that is not deleted.
bool restore_vertex(WriteTransaction& db, MapId map, VertexId vertex);

// Takes the bytes of a vertex' image away; the rest stays. The map's revision grows, unless there were none.
void delete_image_bytes(WriteTransaction& db, MapId map, VertexId vertex);

}  // namespace mapweld
