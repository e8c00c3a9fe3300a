// Tables `images`, `image_poses`, `image_bytes` and `appearances`: every image that a map has taken, as a vertex or
// ignored.
//
// One row of `images` is one upload, so that a name is unique in its map whatever became of the image, and a repeated
// upload finds its first outcome. An image's bytes and its appearances stand in tables of their own: they are big, and
// each can go (pixels deleted) or come (indexed under a second vocabulary) without the other.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "schema/maps/edge_store.h"
#include "schema/maps/map_layout.h"
#include "schema/store.h"
#include "schema/store_types.h"

namespace mapweld {

// What an upload tells about its image, inserted or ignored.
struct NewImage {
  std::string name;        // 1 to 255 bytes, unique in its map
  Sha256 sha256{};         // of the bytes as uploaded
  std::string media_type;  // "image/jpeg" or "image/png"
  int width_px = 0;
  int height_px = 0;
  int features = 0;
  Provenance provenance;
  Reason reason = Reason::kNone;  // inserted without an edge: why
  Timestamp uploaded_at;
  std::span<const std::uint8_t> bytes;  // kept when not empty; need not outlive the call
  std::optional<std::int64_t> owner;    // the number of the key that it came with
};

// Inserts the next vertex of a plain map: image, appearances under `vocabulary` and its edges; the map's revision grows
// by one. `edges`: to vertices that the map has; `NewEdge::v` is ignored and becomes the number that is returned.
VertexId insert_vertex(WriteTransaction& db, MapId map, VocabularyId vocabulary, const NewImage& image,
                       const AppearanceVector& appearances, std::span<const NewEdge> edges, VerifierId verifier);

// Why an image was not inserted.
enum class IgnoredReason : std::uint8_t {
  kTooSimilar,  // it shows too much of what a vertex shows
  kIdentical,   // the map has an image of the same bytes
};
// The word of http-api.md: "too_similar", "identical".
std::string_view to_string(IgnoredReason reason);

// Remembers an image that was not inserted because of what `similar_to` shows. Grows the revision.
ImageId insert_ignored(WriteTransaction& db, MapId map, const NewImage& image, VertexId similar_to, int inliers,
                       IgnoredReason reason = IgnoredReason::kTooSimilar);

struct ImageRow {
  ImageId id{};
  MapId map{};                     // the plain map that took it
  std::optional<VertexId> vertex;  // its number there; none: ignored
  std::string name;
  Sha256 sha256{};
  std::string media_type;
  int width_px = 0;
  int height_px = 0;
  int features = 0;
  int static_features = 0;  // of them; what the map took for static
  Provenance provenance;
  Reason reason = Reason::kNone;
  std::optional<VertexId> similar_to;                         // ignored: the vertex that it resembles too much
  int inliers = 0;                                            // ignored: to that vertex
  IgnoredReason ignored_reason = IgnoredReason::kTooSimilar;  // ignored: why
  Timestamp uploaded_at;
  std::optional<Timestamp> deleted_at;  // tombstone (vertex_removal.h): number and name stay taken
};

// By name, inserted, ignored or deleted: how a repeated upload is recognised.
std::optional<ImageRow> find_image(const Reader& db, MapId map, std::string_view name);
// By its bytes: a vertex where there is one, else an ignored image, the first of them; not one that was deleted, nor
// one that was ignored for a vertex that was.
std::optional<ImageRow> find_image(const Reader& db, MapId map, const Sha256& sha256);
// None that was deleted, as below.
std::optional<ImageRow> find_vertex(const Reader& db, MapId map, VertexId vertex);

// The bytes as they were uploaded; nullopt when they were not kept.
std::optional<std::vector<std::uint8_t>> load_image_bytes(const Reader& db, ImageId image);

// Ignored images of a map in order of arrival, those after `after`.
std::vector<ImageRow> list_ignored(const Reader& db, MapId map, std::size_t limit, std::optional<ImageId> after = {});

// A vertex as a map shows it: for a merged map `vertex` is its own number, `image.map` and `image.vertex` the member's.
struct VertexRow {
  VertexId vertex{};
  ImageRow image;
};
// Up to `limit` vertices of any map, ascending, those after `after`.
std::vector<VertexRow> list_vertices(const Reader& db, const MapLayout& layout, std::size_t limit,
                                     std::optional<VertexId> after = {});
// Those named `name`, ascending: at most one in a plain map, at most one a member in a merged one.
std::vector<VertexRow> find_vertices(const Reader& db, const MapLayout& layout, std::string_view name);

// The appearance vector of a vertex of a plain map, bit for bit as inserted. Throws std::out_of_range when the map has
// no such vertex under this vocabulary, StoreError kCorrupt when the blob is damaged. A deleted one still has it, a
// purged one has none: nothing.
AppearanceVector load_appearances(const Reader& db, MapId map, VocabularyId vocabulary, VertexId vertex);

// Those of the vertices first .. first+count-1 of a plain map, in order; an empty one for each that is deleted or
// purged. Throws as load_appearances.
std::vector<AppearanceVector> load_appearances(const Reader& db, MapId map, VocabularyId vocabulary, VertexId first,
                                               std::uint32_t count);

// Those of the last `newest` of a plain map's first `vertices` vertices, without the images of which nothing is static.
std::vector<AppearanceVector> load_newest_with_static(const Reader& db, MapId map, VocabularyId vocabulary,
                                                      std::uint32_t vertices, std::uint32_t newest);

// Whether the appearances of a map of any kind have signatures. A map gets all its images from one version of the
// program or later ones: the first image of each of its leaves with appearances tells. True for one without any.
bool has_signatures(const Reader& db, const MapLayout& layout, VocabularyId vocabulary);

}  // namespace mapweld
