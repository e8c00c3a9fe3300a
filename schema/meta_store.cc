#include "schema/meta_store.h"

namespace mapweld {

std::optional<std::string> find_meta(const Reader& db, std::string_view key) {
  sqlite::Statement row = db.prepare("SELECT value FROM meta WHERE key = ?");
  if (!row.bind(1, key).step()) return std::nullopt;
  return std::string(row.text(0));
}

void set_meta(WriteTransaction& db, std::string_view key, std::string_view value) {
  db.prepare("INSERT INTO meta (key, value) VALUES (?, ?) ON CONFLICT (key) DO UPDATE SET value = excluded.value")
      .bind_all(key, value)
      .run();
}

}  // namespace mapweld
