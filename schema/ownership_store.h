// Which key has brought what, and how much each has (docs/operations.md, "Quotas"). A key is known by its number
// (key_store.h). Deleting gives back: the triggers of the tables see to that.
#pragma once

#include <cstdint>

#include "schema/store.h"
#include "schema/store_types.h"

namespace mapweld {

struct KeyUsage {
  std::int64_t images = 0;         // vertices and ignored ones, but for those that are deleted
  std::int64_t bytes = 0;          // that are kept of them
  std::int64_t queued_merges = 0;  // or running
  friend bool operator==(const KeyUsage&, const KeyUsage&) = default;
};

KeyUsage usage_of(const Reader& db, std::int64_t key);

// Of what nobody has; what has an owner keeps it.
void own_image(WriteTransaction& db, ImageId image, std::int64_t key);
void own_vertex(WriteTransaction& db, MapId map, VertexId vertex, std::int64_t key);
void own_images_of(WriteTransaction& db, MapId map, std::int64_t key);

// Whoever had it before.
void own_merge(WriteTransaction& db, JobId merge, std::int64_t key);

}  // namespace mapweld
