#include "schema/maps/camera_store.h"

#include "schema/maps/map_store.h"

namespace mapweld {

void set_map_camera(WriteTransaction& db, MapId map, const std::optional<std::string>& camera) {
  if (find_map_camera(db, map) == camera) return;
  if (camera) {
    db.prepare("INSERT OR REPLACE INTO map_cameras (map, camera) VALUES (?, ?)").bind_all(map, *camera).run();
  } else {
    db.prepare("DELETE FROM map_cameras WHERE map = ?").bind_all(map).run();
  }
  const auto grow_revision = [&](MapId grown) {
    db.prepare("UPDATE maps SET revision = revision + 1 WHERE id = ?").bind_all(grown).run();
  };
  grow_revision(map);
  for (const MapRow& merged : list_all_merged_over(db, map)) grow_revision(merged.id);
}

std::optional<std::string> find_map_camera(const Reader& db, MapId map) {
  sqlite::Statement row = db.prepare("SELECT camera FROM map_cameras WHERE map = ?");
  if (!row.bind_all(map).step()) return std::nullopt;
  return std::string(row.text(0));
}

}  // namespace mapweld
