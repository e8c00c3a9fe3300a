#include "schema/ownership_store.h"

#include <string>

namespace mapweld {
namespace {

// Images without a tombstone that `where` picks out, its parameters from ?2 on.
sqlite::Statement own_where(WriteTransaction& db, const std::string& where) {
  return db.prepare(
      "INSERT INTO owned_images (image, key, bytes) SELECT id, ?1, coalesce(length(bytes), 0) FROM images LEFT JOIN "
      "image_bytes ON image = id WHERE deleted_at_us IS NULL AND " +
      where + " ON CONFLICT (image) DO NOTHING");
}

}  // namespace

KeyUsage usage_of(const Reader& db, std::int64_t key) {
  KeyUsage usage;
  sqlite::Statement images = db.prepare("SELECT images, bytes FROM key_usage WHERE key = ?");
  if (images.bind(1, key).step()) {
    usage.images = images.integer(0);
    usage.bytes = images.integer(1);
  }
  sqlite::Statement merges = db.prepare(
      "SELECT count(*) FROM owned_merges JOIN merges ON merges.id = merge WHERE key = ? AND state IN ('queued', "
      "'running')");
  merges.bind(1, key).step();
  usage.queued_merges = merges.integer(0);
  return usage;
}

void own_image(WriteTransaction& db, ImageId image, std::int64_t key) {
  own_where(db, "id = ?2").bind_all(key, image).run();
}

void own_vertex(WriteTransaction& db, MapId map, VertexId vertex, std::int64_t key) {
  own_where(db, "map = ?2 AND vertex = ?3").bind_all(key, map, vertex).run();
}

void own_images_of(WriteTransaction& db, MapId map, std::int64_t key) {
  own_where(db, "map = ?2").bind_all(key, map).run();
}

void own_merge(WriteTransaction& db, JobId merge, std::int64_t key) {
  db.prepare("INSERT INTO owned_merges (merge, key) VALUES (?, ?) ON CONFLICT (merge) DO UPDATE SET key = excluded.key")
      .bind_all(merge, key)
      .run();
}

}  // namespace mapweld
