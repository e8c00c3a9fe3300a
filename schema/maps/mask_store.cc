#include "schema/maps/mask_store.h"

#include "schema/rows.h"

namespace mapweld {
namespace {

void grow_revision(WriteTransaction& db, MapId map) {
  db.prepare("UPDATE maps SET revision = revision + 1 WHERE id = ?").bind_all(map).run();
}

}  // namespace

void set_mask(WriteTransaction& db, MapId map, const MaskRow& mask, std::span<const std::uint8_t> bytes) {
  db.prepare(
        "INSERT OR REPLACE INTO map_masks (map, sha256, width_px, height_px, used_pixels, set_at_us, bytes) "
        "VALUES (?, ?, ?, ?, ?, ?, ?)")
      .bind_all(map, std::span<const std::uint8_t>(mask.sha256), mask.width_px, mask.height_px, mask.used_pixels,
                rows::microseconds(mask.set_at), bytes)
      .run();
  grow_revision(db, map);
}

bool clear_mask(WriteTransaction& db, MapId map) {
  if (!find_mask(db, map)) return false;
  db.prepare("DELETE FROM map_masks WHERE map = ?").bind_all(map).run();
  grow_revision(db, map);
  return true;
}

std::optional<MaskRow> find_mask(const Reader& db, MapId map) {
  sqlite::Statement row =
      db.prepare("SELECT sha256, width_px, height_px, used_pixels, set_at_us FROM map_masks WHERE map = ?");
  if (!row.bind_all(map).step()) return std::nullopt;
  return MaskRow{.sha256 = rows::sha256(row, 0),
                 .width_px = static_cast<int>(row.integer(1)),
                 .height_px = static_cast<int>(row.integer(2)),
                 .used_pixels = row.integer(3),
                 .set_at = rows::timestamp(row, 4)};
}

std::optional<std::vector<std::uint8_t>> load_mask_bytes(const Reader& db, MapId map) {
  sqlite::Statement row = db.prepare("SELECT bytes FROM map_masks WHERE map = ?");
  if (!row.bind_all(map).step()) return std::nullopt;
  return std::vector<std::uint8_t>(row.blob(0).begin(), row.blob(0).end());
}

}  // namespace mapweld
