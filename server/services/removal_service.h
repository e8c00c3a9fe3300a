// Deleting the images of a map, and restoring them.
#pragma once

#include <cstdint>
#include <string>

#include "schema/maps/map_store.h"
#include "schema/store.h"
#include "server/access/caller.h"
#include "server/maps/map_cache.h"
#include "server/services/keep.h"

namespace mapweld::server {

// Thread-safe. What is deleted is in no answer any more when a call returns; merges over the map follow when they are
// resumed. Takes turns with uploads into the map, which is read anew by whoever uses it next.
//
// Throws ContractError no_such_map, map_is_merged; map_in_use while a merge over the map is queued or running;
// StoreError.
class RemovalService {
 public:
  // Both must outlive this.
  RemovalService(Store& store, MapCache& cache) : store_(store), cache_(cache) {}

  // Each returns how many vertices were deleted. no_such_vertex when it is not there.
  std::int64_t remove(const std::string& map, std::uint32_t vertex);
  std::int64_t remove_named(const std::string& map, const std::string& name);
  // Of `from` .. `to` those that are there. invalid_parameter when `from` is greater.
  std::int64_t remove_range(const std::string& map, std::uint32_t from, std::uint32_t to);

  // Its pixels only, whether there are any or not. no_such_vertex. Never map_in_use.
  void remove_image(const std::string& map, std::uint32_t vertex);

  // Also for a vertex that is not deleted. no_such_vertex for one that never was, or was purged.
  // It becomes the caller's, if there is one: quota_exceeded.
  void restore(const std::string& map, std::uint32_t vertex, const Keep<VertexId>& keep = {},
               const Caller* caller = nullptr);

 private:
  template <typename Change>
  void change(const std::string& map, const Change& change);

  Store& store_;
  MapCache& cache_;
};

}  // namespace mapweld::server
