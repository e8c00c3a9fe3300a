#include "schema/maps/vertex_store.h"

#include <algorithm>
#include <stdexcept>
#include <string>

#include "schema/blobs/appearance_blob.h"
#include "schema/maps/absent_vertices.h"
#include "schema/ownership_store.h"
#include "schema/rows.h"

namespace mapweld {
namespace {

constexpr std::string_view kColumns =
    "SELECT id, map, vertex, name, sha256, media_type, width_px, height_px, features, captured_at_us, sequence, "
    "sequence_index, camera, reason, similar_to, inliers, uploaded_at_us, deleted_at_us, static_features, "
    "(SELECT pose FROM image_poses WHERE image = images.id) FROM images ";

constexpr std::string_view kIdenticalWord = "identical";

ImageRow read_row(const sqlite::Statement& row) {
  ImageRow image;
  image.id = row.id<ImageId>(0);
  image.map = row.id<MapId>(1);
  if (!row.is_null(2)) image.vertex = row.id<VertexId>(2);
  image.name = row.text(3);
  image.sha256 = rows::sha256(row, 4);
  image.media_type = row.text(5);
  image.width_px = static_cast<int>(row.integer(6));
  image.height_px = static_cast<int>(row.integer(7));
  image.features = static_cast<int>(row.integer(8));
  image.provenance.captured_at = rows::optional_timestamp(row, 9);
  image.provenance.sequence = row.optional_text(10);
  image.provenance.index = row.optional_integer(11);
  image.provenance.camera = row.optional_text(12);
  if (!row.is_null(14)) image.similar_to = row.id<VertexId>(14);
  if (image.similar_to && row.text(13) == kIdenticalWord) {
    image.ignored_reason = IgnoredReason::kIdentical;
  } else {
    image.reason = rows::reason(row, 13);
  }
  image.inliers = static_cast<int>(row.integer(15));
  image.uploaded_at = rows::timestamp(row, 16);
  image.deleted_at = rows::optional_timestamp(row, 17);
  image.static_features = static_cast<int>(row.integer(18));
  image.provenance.pose = row.optional_text(19);
  return image;
}

// Counts a new image of a plain map; returns the number of vertices that it had.
std::uint32_t count_image(WriteTransaction& db, MapId map, bool inserted) {
  sqlite::Statement counted = db.prepare(
      "UPDATE maps SET vertices = vertices + ?2, ignored = ignored + 1 - ?2, revision = revision + 1 "
      "WHERE id = ?1 AND kind = 'map' RETURNING vertices - ?2");
  counted.bind_all(map, inserted ? 1 : 0);
  if (!counted.step()) throw StoreError(StoreErrorKind::kConstraint, "images belong to plain maps");
  const std::int64_t vertices = counted.integer(0);
  counted.run();
  if (vertices >= UINT32_MAX) throw StoreError(StoreErrorKind::kConstraint, "a map cannot have 2^32 vertices");
  return static_cast<std::uint32_t>(vertices);
}

// What became of an image.
struct Outcome {
  std::string_view reason;
  std::size_t static_features = 0;
  std::optional<VertexId> vertex = {};
  std::optional<VertexId> similar_to = {};
  std::optional<int> inliers = {};
};

ImageId insert_image(WriteTransaction& db, MapId map, const NewImage& image, const Outcome& outcome) {
  const Provenance& from = image.provenance;
  db.prepare(
        "INSERT INTO images (map, vertex, name, sha256, media_type, width_px, height_px, features, captured_at_us, "
        "sequence, sequence_index, camera, reason, similar_to, inliers, uploaded_at_us, static_features) "
        "VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?)")
      .bind_all(map, outcome.vertex, image.name, std::span<const std::uint8_t>(image.sha256), image.media_type,
                image.width_px, image.height_px, image.features, rows::microseconds(from.captured_at), from.sequence,
                from.index, from.camera, outcome.reason, outcome.similar_to, outcome.inliers,
                rows::microseconds(image.uploaded_at), outcome.static_features)
      .run();
  const ImageId id{db.connection().last_insert_rowid()};
  if (from.pose) db.prepare("INSERT INTO image_poses (image, pose) VALUES (?, ?)").bind_all(id, *from.pose).run();
  if (!image.bytes.empty()) {
    db.prepare("INSERT INTO image_bytes (image, bytes) VALUES (?, ?)").bind_all(id, image.bytes).run();
  }
  if (image.owner) own_image(db, id, *image.owner);
  return id;
}

}  // namespace

VertexId insert_vertex(WriteTransaction& db, MapId map, VocabularyId vocabulary, const NewImage& image,
                       const AppearanceVector& appearances, std::span<const NewEdge> edges, VerifierId verifier) {
  const VertexId vertex{count_image(db, map, true)};
  insert_image(
      db, map, image,
      {.reason = to_string(image.reason), .static_features = appearances.static_appearances.size(), .vertex = vertex});
  const blobs::Bytes bytes = blobs::encode_appearances(appearances);
  db.prepare("INSERT INTO appearances (map, vertex, vocabulary, bytes) VALUES (?, ?, ?, ?)")
      .bind_all(map, vertex, vocabulary, std::span<const std::uint8_t>(bytes))
      .run();
  std::vector<NewEdge> own(edges.begin(), edges.end());
  for (NewEdge& edge : own) edge.v = vertex;
  insert_edges(db, map, own, verifier, std::nullopt);
  return vertex;
}

std::string_view to_string(IgnoredReason reason) {
  return reason == IgnoredReason::kIdentical ? kIdenticalWord : "too_similar";
}

ImageId insert_ignored(WriteTransaction& db, MapId map, const NewImage& image, VertexId similar_to, int inliers,
                       IgnoredReason reason) {
  count_image(db, map, false);
  const std::string_view stored = reason == IgnoredReason::kIdentical ? kIdenticalWord : "";
  return insert_image(db, map, image, {.reason = stored, .similar_to = similar_to, .inliers = inliers});
}

std::optional<ImageRow> find_image(const Reader& db, MapId map, std::string_view name) {
  sqlite::Statement row = db.prepare(std::string(kColumns) + "WHERE map = ? AND name = ?");
  if (!row.bind_all(map, name).step()) return std::nullopt;
  return read_row(row);
}

std::optional<ImageRow> find_image(const Reader& db, MapId map, const Sha256& sha256) {
  sqlite::Statement row =
      db.prepare(std::string(kColumns) +
                 "WHERE map = ? AND sha256 = ? AND deleted_at_us IS NULL AND (vertex IS NOT NULL OR EXISTS (SELECT 1 "
                 "FROM images s "
                 "WHERE s.map = images.map AND s.vertex = images.similar_to AND s.deleted_at_us IS NULL)) "
                 "ORDER BY vertex IS NULL, id LIMIT 1");
  if (!row.bind_all(map, std::span<const std::uint8_t>(sha256)).step()) return std::nullopt;
  return read_row(row);
}

std::optional<ImageRow> find_vertex(const Reader& db, MapId map, VertexId vertex) {
  sqlite::Statement row = db.prepare(std::string(kColumns) + "WHERE map = ? AND vertex = ? AND deleted_at_us IS NULL");
  if (!row.bind_all(map, vertex).step()) return std::nullopt;
  return read_row(row);
}

std::optional<std::vector<std::uint8_t>> load_image_bytes(const Reader& db, ImageId image) {
  sqlite::Statement row = db.prepare("SELECT bytes FROM image_bytes WHERE image = ?");
  if (!row.bind(1, image).step()) return std::nullopt;
  return std::vector<std::uint8_t>(row.blob(0).begin(), row.blob(0).end());
}

std::vector<ImageRow> list_ignored(const Reader& db, MapId map, std::size_t limit, std::optional<ImageId> after) {
  sqlite::Statement row =
      db.prepare(std::string(kColumns) + "WHERE map = ? AND vertex IS NULL AND id > ? ORDER BY id LIMIT ?");
  row.bind_all(map, after.value_or(ImageId{0}), limit);
  std::vector<ImageRow> images;
  while (row.step()) images.push_back(read_row(row));
  return images;
}

std::vector<VertexRow> list_vertices(const Reader& db, const MapLayout& layout, std::size_t limit,
                                     std::optional<VertexId> after) {
  std::vector<VertexRow> vertices;
  const std::uint64_t begin = after ? std::uint64_t{to_index(*after)} + 1 : 0;
  for (const MapLayout::LeafSpan& span : layout.leaf_spans()) {
    const std::uint64_t first = to_index(span.first);
    if (begin >= first + span.count) continue;
    const std::uint64_t skipped = begin > first ? begin - first : 0;
    sqlite::Statement row =
        db.prepare(std::string(kColumns) +
                   "WHERE map = ? AND vertex >= ? AND vertex < ? AND deleted_at_us IS NULL ORDER BY vertex LIMIT ?");
    const std::uint64_t leaf_first = to_index(span.leaf_first);
    row.bind_all(span.leaf, leaf_first + skipped, leaf_first + span.count, limit - vertices.size());
    while (row.step()) {
      ImageRow image = read_row(row);
      const auto number = static_cast<std::uint32_t>(first + (to_index(*image.vertex) - leaf_first));
      vertices.push_back({VertexId{number}, std::move(image)});
    }
    if (vertices.size() == limit) break;
  }
  return vertices;
}

std::vector<VertexRow> find_vertices(const Reader& db, const MapLayout& layout, std::string_view name) {
  std::vector<VertexRow> vertices;
  for (const LayoutNode& node : layout.nodes()) {
    if (node.kind != MapKind::kMap) continue;
    auto image = find_image(db, node.map, name);
    if (!image || !image->vertex || image->deleted_at) continue;
    if (const auto number = node.number(*image->vertex)) vertices.push_back({*number, std::move(*image)});
  }
  std::ranges::sort(vertices, {}, &VertexRow::vertex);
  return vertices;
}

AppearanceVector load_appearances(const Reader& db, MapId map, VocabularyId vocabulary, VertexId vertex) {
  sqlite::Statement row = db.prepare("SELECT bytes FROM appearances WHERE map = ? AND vertex = ? AND vocabulary = ?");
  if (!row.bind_all(map, vertex, vocabulary).step()) {
    if (!absent_vertices(db, map, vertex, 1).empty()) return {};
    throw std::out_of_range("map " + std::to_string(to_index(map)) + " has no vertex " +
                            std::to_string(to_index(vertex)) + " under this vocabulary");
  }
  return blobs::decode_appearances(row.blob(0));
}

std::vector<AppearanceVector> load_appearances(const Reader& db, MapId map, VocabularyId vocabulary, VertexId first,
                                               std::uint32_t count) {
  const VertexSet absent = absent_vertices(db, map, first, count);
  std::vector<AppearanceVector> images;
  images.reserve(count);
  sqlite::Statement row = db.prepare(
      "SELECT vertex, bytes FROM appearances WHERE map = ? AND vertex >= ? AND vertex < ? AND vocabulary = ? "
      "ORDER BY vertex");
  const std::uint64_t begin = to_index(first);
  row.bind_all(map, begin, begin + count, vocabulary);
  const auto next = [&] { return VertexId{static_cast<std::uint32_t>(begin + images.size())}; };
  const auto pass_over_absent = [&] {
    while (absent.contains(next())) images.emplace_back();
  };
  while (row.step()) {
    const auto vertex = row.id<VertexId>(0);
    if (absent.contains(vertex)) continue;
    pass_over_absent();
    if (vertex != next()) break;
    images.push_back(blobs::decode_appearances(row.blob(1)));
  }
  pass_over_absent();
  if (images.size() != count) {
    throw std::out_of_range("map " + std::to_string(to_index(map)) + " has no vertex " +
                            std::to_string(to_index(next())) + " under this vocabulary");
  }
  return images;
}

std::vector<AppearanceVector> load_newest_with_static(const Reader& db, MapId map, VocabularyId vocabulary,
                                                      std::uint32_t vertices, std::uint32_t newest) {
  sqlite::Statement row = db.prepare(
      "SELECT a.bytes FROM images i JOIN appearances a ON a.map = i.map AND a.vertex = i.vertex AND a.vocabulary = ? "
      "WHERE i.map = ? AND i.vertex >= ? AND i.vertex < ? AND i.static_features > 0 "
      "AND i.deleted_at_us IS NULL ORDER BY i.vertex");
  row.bind_all(vocabulary, map, vertices > newest ? vertices - newest : 0, vertices);
  std::vector<AppearanceVector> images;
  while (row.step()) images.push_back(blobs::decode_appearances(row.blob(0)));
  return images;
}

bool has_signatures(const Reader& db, const MapLayout& layout, VocabularyId vocabulary) {
  sqlite::Statement row = db.prepare(
      "SELECT a.bytes FROM images i JOIN appearances a ON a.map = i.map AND a.vertex = i.vertex AND a.vocabulary = ? "
      "WHERE i.map = ? AND i.vertex IS NOT NULL AND i.features > i.static_features ORDER BY i.vertex LIMIT 1");
  return std::ranges::all_of(layout.leaf_spans(), [&](const MapLayout::LeafSpan& span) {
    row.bind_all(vocabulary, span.leaf);
    const bool has = !row.step() || blobs::decode_appearances(row.blob(0)).appearances.front().signature != Signature{};
    row.reset();
    return has;
  });
}

}  // namespace mapweld
