#include "server/services/map_service.h"

#include <algorithm>
#include <stdexcept>

#include "client/contract/problem.h"
#include "core/mapping/static_content.h"
#include "schema/maps/absent_vertices.h"
#include "schema/maps/camera_store.h"
#include "schema/maps/edge_store.h"
#include "schema/maps/mask_store.h"
#include "schema/maps/vertex_store.h"
#include "schema/merges/merge_store.h"
#include "server/maps/map_settings.h"
#include "server/services/cameras.h"
#include "server/services/describe.h"
#include "server/services/hashing.h"
#include "server/services/map_lookup.h"
#include "server/services/paging.h"
#include "server/services/times.h"
#include "server/services/uuid.h"
#include "server/services/visible_rows.h"

namespace mapweld::server {
namespace {

using contract::ContractError;

// Of one vertex.
std::int64_t degree_of(const Reader& db, const MapLayout& layout, VertexId vertex) {
  return count_confirmed_edges_at(db, layout, vertex, 1).front();
}

VertexRow read_vertex(const Reader& db, const MapRow& map, const MapLayout& layout, std::uint32_t vertex) {
  const LeafVertex leaf = require_vertex(db, map, layout, vertex);
  return {VertexId{vertex}, find_vertex(db, leaf.map, leaf.vertex).value()};
}

// As the newest images show it; of a merged map, the mean over the vertices of its members.
double static_share_of(const Reader& db, const MapRow& map, const MapLayout& layout) {
  constexpr std::uint32_t kNewest = 16;
  double sum = 0;
  std::size_t all = 0;
  for (const LayoutNode& node : layout.nodes()) {
    if (node.kind != MapKind::kMap) continue;
    const std::size_t there = node.watermark - absent_vertices(db, node.map, VertexId{0}, node.watermark).size();
    sum += static_cast<double>(there) *
           static_share(load_newest_with_static(db, node.map, map.vocabulary, node.watermark, kNewest));
    all += there;
  }
  return all == 0 ? 0 : sum / static_cast<double>(all);
}

void require_consistent(const MapSettings& settings) {
  if (settings.parameters.min_inliers > settings.parameters.max_inliers) {
    throw ContractError("invalid_parameter", "\"parameters.min_inliers\" must not exceed \"parameters.max_inliers\".");
  }
}

// What images were taken in by, and edges made by, stays: it would no longer be true of them.
void require_mutable(const MapSettings& before, const MapSettings& after) {
  const MapParameters& a = before.parameters;
  const MapParameters& b = after.parameters;
  for (const auto& [name, stays] : {std::pair("max_features", a.max_features == b.max_features),
                                    {"votes", a.votes == b.votes},
                                    {"min_votes", a.min_votes == b.min_votes},
                                    {"min_inliers", a.min_inliers == b.min_inliers}}) {
    if (stays) continue;
    throw ContractError(
        "immutable_parameter",
        "\"parameters." + std::string(name) + "\" is settled when a map is made: its images and edges rest on it.");
  }
  require_consistent(after);
}

EdgeCursor parse_edge_cursor(const std::optional<std::string>& cursor) {
  if (!cursor) return {};
  const std::size_t dash = cursor->find('-');
  if (dash == std::string::npos) {
    throw ContractError("invalid_parameter", "\"cursor\" is not one that a page gave.");
  }
  return {static_cast<std::uint32_t>(parse_cursor(std::string_view(*cursor).substr(0, dash))),
          parse_cursor(std::string_view(*cursor).substr(dash + 1))};
}

}  // namespace

contract::Map MapService::create(const contract::CreateMap& request, const Caller* caller,
                                 const Keep<contract::Map>& keep) {
  contract::check(request);
  require_use(caller, request.name);
  NewMap map;
  map.name = request.name;
  map.uuid = request.uuid.value_or(make_uuid());
  std::ranges::transform(map.uuid, map.uuid.begin(), [](unsigned char c) { return std::tolower(c); });
  const MapSettings settings = settings_of(request.parameters.value_or(contract::MapParameters{}));
  require_consistent(settings);
  map.parameters = to_row(settings);
  if (request.labels) map.labels = labels_to_row(*request.labels);
  map.created_at = now();

  WriteTransaction db = store_.write();
  map.vocabulary = vocabularies_.resolve(db, request.vocabulary).id;
  if (find_map(db, map.name)) throw ContractError("name_taken", "There is a map named \"" + map.name + "\" already.");
  if (const auto other = find_map_by_uuid(db, map.uuid)) {
    throw ContractError("name_taken", "The map \"" + other->name + "\" has this uuid already.");
  }
  const MapId id = insert_map(db, map);
  contract::Map created = describe(db, find_map(db, id).value());
  if (keep) keep(db, created);
  db.commit();
  return created;
}

contract::Map MapService::change(const std::string& name, const contract::ChangeMap& request, const Caller* caller) {
  contract::check(request);
  if (request.name) require_use(caller, *request.name);
  WriteTransaction db = store_.write();
  const MapRow map = require_map(db, name);
  const std::string new_name = request.name.value_or(map.name);
  if (new_name != map.name && find_map(db, new_name)) {
    throw ContractError("name_taken", "There is a map named \"" + new_name + "\" already.");
  }
  const std::string labels = request.labels ? labels_to_row(*request.labels) : map.labels;
  std::string parameters = map.parameters;
  if (request.parameters) {
    const MapSettings before = settings_of(map);
    const MapSettings after = changed(before, *request.parameters);
    require_mutable(before, after);
    if (mapweld::server::describe(after) != mapweld::server::describe(before)) parameters = to_row(after);
  }
  if (new_name != map.name || labels != map.labels || parameters != map.parameters) {
    change_map(db, map.id, new_name, labels, parameters);
  }
  if (request.camera) {
    if (map.kind == MapKind::kMerged) {
      throw ContractError("map_is_merged", "\"" + name + "\" is a merged map; its members have cameras.");
    }
    const bool taken_away = *request.camera == contract::Camera{};
    set_map_camera(db, map.id, taken_away ? std::nullopt : std::optional(camera_to_row(*request.camera)));
  }
  contract::Map now = describe(db, require_map(db, new_name));
  db.commit();
  return now;
}

contract::Map MapService::get(const std::string& name) const { return get(store_.read(), name); }

contract::Map MapService::get(const Reader& db, const std::string& name) const {
  return describe(db, require_map(db, name));
}

contract::Page<contract::Map> MapService::list(const PageRequest& page, const Caller* caller) const {
  const ReadTransaction db = store_.read();
  const auto rows = read_visible(
      page.limit + 1, after<MapId>(page.cursor),
      [&](std::size_t count, const std::optional<MapId>& from) { return list_maps(db, count, from); },
      [&](const MapRow& map) { return sees_all(caller) || caller->may_use(map.name); });
  return make_page<contract::Page<contract::Map>>(
      rows, page.limit, [&](const MapRow& map) { return describe(db, map); },
      [](const MapRow& map) { return to_index(map.id); });
}

void MapService::remove(const std::string& name) {
  MapRow map;
  std::optional<MergeRow> merge;
  {
    const ReadTransaction db = store_.read();
    map = require_map(db, name);
    if (map.kind == MapKind::kMerged) merge = find_merge_of(db, map.id);
  }
  if (merge) {
    remove_merge_(to_index(merge->id));
  } else {
    WriteTransaction db = store_.write(Store::Purpose::kDelete);
    switch (delete_map(db, map.id)) {
      case DeleteOutcome::kDeleted:
        break;
      case DeleteOutcome::kNotFound:
        throw ContractError("no_such_map", "There is no map named \"" + name + "\".");
      case DeleteOutcome::kInUse: {
        const std::vector<MapRow> users = list_merged_over(db, map.id);
        throw ContractError("map_in_use", "The merged map \"" + (users.empty() ? "" : users.front().name) +
                                              "\" is made of it; delete that first.");
      }
    }
    db.commit();
  }
  opener_.forget(map.id);
}

contract::Map MapService::describe(const Reader& db, const MapRow& map) const {
  contract::Map out;
  out.name = map.name;
  out.kind = to_string(map.kind);
  const std::optional<VocabularyRow> vocabulary = find_vocabulary(db, map.vocabulary);
  out.vocabulary = vocabulary ? vocabulary->name : "";
  const MapLayout layout = load_layout(db, map.id);
  out.vertices = map.vertices - static_cast<std::int64_t>(absent_vertices(db, layout).size());
  out.edge_counts = {.verified = static_cast<std::int64_t>(count_edges(db, layout)),
                     .confirmed = static_cast<std::int64_t>(count_edges(db, layout, {.confirmed = true}))};
  out.edges = out.edge_counts.confirmed;
  out.ignored = static_cast<std::int64_t>(map.ignored);
  out.uuid = map.uuid;
  out.parameters = mapweld::server::describe(settings_of(map));
  out.labels = labels_of(map);
  if (const std::optional<MaskRow> mask = find_mask(db, map.id)) {
    const double pixels = static_cast<double>(mask->width_px) * mask->height_px;
    out.mask = {.width_px = mask->width_px,
                .height_px = mask->height_px,
                .used_share = static_cast<double>(mask->used_pixels) / pixels,
                .sha256 = to_hex(mask->sha256)};
  }
  out.camera = camera_of_map(db, map.id);
  out.static_share = static_share_of(db, map, layout);
  if (map.kind == MapKind::kMerged) {
    for (const MemberRow& member : list_members(db, map.id)) out.members.push_back({member.name, member.watermark});
    if (const std::optional<MergeRow> merge = find_merge_of(db, map.id)) out.merge = to_index(merge->id);
  }
  out.created_at = to_rfc3339(map.created_at);
  out.revision = static_cast<std::int64_t>(map.revision);
  return out;
}

contract::Page<contract::Vertex> MapService::vertices(const std::string& map_name,
                                                      const std::optional<std::string>& name,
                                                      const PageRequest& page) const {
  const ReadTransaction db = store_.read();
  const MapRow map = require_map(db, map_name);
  const MapLayout layout = load_layout(db, map.id);
  const std::optional<VertexId> from = after<VertexId>(page.cursor);
  std::vector<VertexRow> rows;
  if (name) {
    rows = find_vertices(db, layout, *name);
    if (from) std::erase_if(rows, [&](const VertexRow& row) { return row.vertex <= *from; });
  } else {
    rows = list_vertices(db, layout, page.limit + 1, from);
  }
  // A page follows on from vertex to vertex; those of a name lie apart.
  std::vector<std::int64_t> degrees;
  if (!name && !rows.empty()) {
    const VertexId first = rows.front().vertex;
    degrees = count_confirmed_edges_at(db, layout, first, to_index(rows.back().vertex) - to_index(first) + 1);
  }
  MapNames names(db);
  return make_page<contract::Page<contract::Vertex>>(
      rows, page.limit,
      [&](const VertexRow& row) {
        const std::int64_t degree =
            name ? degree_of(db, layout, row.vertex) : degrees[to_index(row.vertex) - to_index(rows.front().vertex)];
        return describe_vertex(row, names(row.image.map), degree);
      },
      [](const VertexRow& row) { return to_index(row.vertex); });
}

contract::Vertex MapService::vertex(const std::string& map_name, std::uint32_t vertex) const {
  return this->vertex(store_.read(), map_name, vertex);
}

contract::Vertex MapService::vertex(const Reader& db, const std::string& map_name, std::uint32_t vertex) const {
  const MapRow map = require_map(db, map_name);
  const MapLayout layout = load_layout(db, map.id);
  const VertexRow row = read_vertex(db, map, layout, vertex);
  return describe_vertex(row, MapNames(db)(row.image.map), degree_of(db, layout, row.vertex));
}

StoredImage MapService::image(const std::string& map_name, std::uint32_t vertex) const {
  const ReadTransaction db = store_.read();
  const MapRow map = require_map(db, map_name);
  const VertexRow row = read_vertex(db, map, load_layout(db, map.id), vertex);
  const auto bytes = load_image_bytes(db, row.image.id);
  if (!bytes) {
    throw ContractError("no_such_image", "The bytes of this image are not kept.");
  }
  return {row.image.media_type, std::string(bytes->begin(), bytes->end()), to_hex(row.image.sha256)};
}

contract::Page<contract::IgnoredImage> MapService::ignored(const std::string& map_name, const PageRequest& page) const {
  const ReadTransaction db = store_.read();
  const MapRow map = require_map(db, map_name);
  return make_page<contract::Page<contract::IgnoredImage>>(
      list_ignored(db, map.id, page.limit + 1, after<ImageId>(page.cursor)), page.limit, describe_ignored,
      [](const ImageRow& row) { return to_index(row.id); });
}

contract::Page<contract::Edge> MapService::edges(const std::string& map_name, const EdgeQuery& query,
                                                 const PageRequest& page) const {
  const ReadTransaction db = store_.read();
  const MapRow map = require_map(db, map_name);
  const EdgePage found =
      list_edges(db, load_layout(db, map.id),
                 {.min_inliers = query.min_inliers, .inter = query.inter, .confirmed = query.confirmed}, page.limit,
                 parse_edge_cursor(page.cursor));
  contract::Page<contract::Edge> out;
  for (const EdgeRow& edge : found.edges) out.items.push_back(describe_edge(edge));
  if (found.next) out.next_cursor = std::to_string(found.next->node) + "-" + std::to_string(found.next->edge);
  return out;
}

}  // namespace mapweld::server
