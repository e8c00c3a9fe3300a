// Table `maps`: plain maps, which own vertices, and merged maps, which are views over members (tables `maps`,
// `member_spans`; the numbering of a merged map is in map_layout.h).
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "schema/store.h"
#include "schema/store_types.h"

namespace mapweld {

enum class MapKind : std::uint8_t { kMap, kMerged };
std::string_view to_string(MapKind kind);  // "map", "merged"

struct NewMap {
  std::string name;  // slug, unique
  std::string uuid;  // 36 characters, unique
  VocabularyId vocabulary{};
  std::string parameters = "{}";  // JSON object, kept as given
  std::string labels = "{}";      // JSON object, kept as given
  Timestamp created_at;
};

struct MapRow : NewMap {
  MapId id{};
  MapKind kind = MapKind::kMap;
  std::uint32_t vertices = 0;     // numbers given so far; a merged map: those of its members up to their watermarks
  std::uint64_t edges = 0;        // its own: inner edges of a plain map, inter edges of a merged one
  std::uint64_t unconfirmed = 0;  // of its edges
  std::uint64_t judgements = 0;   // how often what is thought of its edges was changed
  std::uint64_t ignored = 0;      // images that were not inserted
  std::uint64_t revision = 0;  // grows with every image taken, inserted or ignored, every change of a merged map, and
                               // every judgement
};

// Creates a plain map. Name and uuid must be free: ask in the same transaction first (the writer is alone, so the
// answer holds).
MapId insert_map(WriteTransaction& db, const NewMap& map);

// Creates a merged map over `members`, two or more in the order given, each up to its present number of vertices.
// Nothing is copied. `map.vocabulary` must be the members' own.
MapId insert_merged_map(WriteTransaction& db, const NewMap& map, std::span<const MapId> members);

// Takes in the vertices that members have gained since: their numbers are appended, member by member. Returns how many.
std::uint32_t extend_merged_map(WriteTransaction& db, MapId merged);

std::optional<MapRow> find_map(const Reader& db, std::string_view name);
std::optional<MapRow> find_map(const Reader& db, MapId id);
std::optional<MapRow> find_map_by_uuid(const Reader& db, std::string_view uuid);

// Up to `limit` maps in order of id, those after `after`.
std::vector<MapRow> list_maps(const Reader& db, std::size_t limit, std::optional<MapId> after = {});

struct MemberRow {
  MapId map{};
  std::string name;
  std::uint32_t watermark = 0;  // so many of its vertices show through
  std::uint32_t vertices = 0;   // so many it has now
};
// The members of a merged map in the order given; none for a plain map.
std::vector<MemberRow> list_members(const Reader& db, MapId merged);

// The merged maps that name `map` as a member, in order of id.
std::vector<MapRow> list_merged_over(const Reader& db, MapId map);
// The same of all levels of merging.
std::vector<MapRow> list_all_merged_over(const Reader& db, MapId map);

// Changes the name, which must be free, the labels and the parameters (JSON objects). Its revision grows, and with
// another name those of the merged maps over it, of all levels. False when there is no such map.
bool change_map(WriteTransaction& db, MapId map, std::string_view name, std::string_view labels,
                std::string_view parameters);

enum class DeleteOutcome : std::uint8_t { kDeleted, kNotFound, kInUse };

// Deletes a map with everything it owns: images, appearances, segments, edges; a merged map with its merge, leaving its
// members as they are. kInUse, and nothing changed, while a merged map names it.
DeleteOutcome delete_map(WriteTransaction& db, MapId map);

}  // namespace mapweld
