#include "server/services/removal_service.h"

#include <optional>

#include "client/contract/problem.h"
#include "schema/maps/vertex_removal.h"
#include "schema/maps/vertex_store.h"
#include "schema/merges/merge_store.h"
#include "server/services/map_lookup.h"
#include "server/services/quotas.h"
#include "server/services/times.h"

namespace mapweld::server {
namespace {

using contract::ContractError;

constexpr std::string_view kInstead = "its images are those of its members.";  // of a merged map

void require_merges_at_rest(const Reader& db, const MapRow& map) {
  for (const MapRow& merged : list_all_merged_over(db, map.id)) {
    const std::optional<MergeRow> merge = find_merge_of(db, merged.id);
    if (!merge || (merge->state != JobState::kQueued && merge->state != JobState::kRunning)) continue;
    throw ContractError("map_in_use", "Merge " + std::to_string(to_index(merge->id)) + ", which \"" + map.name +
                                          "\" is part of, is " + std::string(to_string(merge->state)) +
                                          "; pause it first.");
  }
}

}  // namespace

template <typename Change>
void RemovalService::change(const std::string& name, const Change& change) {
  const MapId id = require_plain_map(store_.read(), name, kInstead).id;
  const auto turn = cache_.writer_turn(id);
  {
    WriteTransaction db = store_.write(Store::Purpose::kDelete);
    const MapRow map = require_plain_map(db, name, kInstead);
    if (map.id != id) throw ContractError("no_such_map", "The map \"" + name + "\" was deleted.");
    require_merges_at_rest(db, map);
    change(db, map);
    db.commit();
  }
  cache_.forget(id);
}

std::int64_t RemovalService::remove(const std::string& map, std::uint32_t vertex) {
  change(map, [&](WriteTransaction& db, const MapRow& row) {
    require_vertex(db, row, load_layout(db, row.id), vertex);
    delete_vertices(db, row.id, VertexId{vertex}, 1, now());
  });
  return 1;
}

std::int64_t RemovalService::remove_named(const std::string& map, const std::string& name) {
  change(map, [&](WriteTransaction& db, const MapRow& row) {
    const std::optional<ImageRow> image = find_image(db, row.id, name);
    if (!image || !image->vertex || image->deleted_at) {
      throw ContractError("no_such_vertex", "The map \"" + map + "\" has no vertex of this name.");
    }
    delete_vertices(db, row.id, *image->vertex, 1, now());
  });
  return 1;
}

std::int64_t RemovalService::remove_range(const std::string& map, std::uint32_t from, std::uint32_t to) {
  if (from > to) throw ContractError("invalid_parameter", "\"from\" must not be greater than \"to\".");
  std::uint64_t deleted = 0;
  change(map, [&](WriteTransaction& db, const MapRow& row) {
    deleted = delete_vertices(db, row.id, VertexId{from}, std::uint64_t{to} - from + 1, now());
  });
  return static_cast<std::int64_t>(deleted);
}

void RemovalService::remove_image(const std::string& map, std::uint32_t vertex) {
  WriteTransaction db = store_.write(Store::Purpose::kDelete);
  const MapRow row = require_plain_map(db, map, kInstead);
  require_vertex(db, row, load_layout(db, row.id), vertex);
  delete_image_bytes(db, row.id, VertexId{vertex});
  db.commit();
}

void RemovalService::restore(const std::string& map, std::uint32_t vertex, const Keep<VertexId>& keep,
                             const Caller* caller) {
  change(map, [&](WriteTransaction& db, const MapRow& row) {
    if (!restore_vertex(db, row.id, VertexId{vertex})) {
      require_vertex(db, row, load_layout(db, row.id), vertex);
    } else if (caller != nullptr) {
      own_vertex(db, row.id, VertexId{vertex}, caller->id);
      require_images_fit(db, caller);
    }
    if (keep) keep(db, VertexId{vertex});
  });
}

}  // namespace mapweld::server
