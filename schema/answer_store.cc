#include "schema/answer_store.h"

#include "schema/rows.h"

namespace mapweld {

std::vector<KeptAnswer> find_answers(const Reader& db, const AnswerKey& key, Timestamp since) {
  sqlite::Statement row = db.prepare(
      "SELECT part, request, status, headers, body, map, kept_at_us FROM kept_answers WHERE caller = ? AND key = ? AND "
      "kept_at_us >= ? ORDER BY part");
  row.bind_all(key.caller, key.text, rows::microseconds(since));
  std::vector<KeptAnswer> answers;
  while (row.step()) {
    answers.push_back({.part = row.integer(0),
                       .request = rows::sha256(row, 1),
                       .status = static_cast<int>(row.integer(2)),
                       .headers = std::string(row.text(3)),
                       .body = std::string(row.text(4)),
                       .map = row.is_null(5) ? std::nullopt : std::optional(row.id<MapId>(5)),
                       .kept_at = rows::timestamp(row, 6)});
  }
  return answers;
}

void keep_answer(WriteTransaction& db, const AnswerKey& key, const KeptAnswer& answer) {
  db.prepare("DELETE FROM kept_answers WHERE caller = ? AND key = ? AND part = ?")
      .bind_all(key.caller, key.text, answer.part)
      .run();
  db.prepare(
        "INSERT INTO kept_answers (caller, key, part, request, status, headers, body, map, kept_at_us) VALUES (?, ?, "
        "?, ?, ?, ?, ?, ?, ?)")
      .bind_all(key.caller, key.text, answer.part, std::span<const std::uint8_t>(answer.request), answer.status,
                answer.headers, answer.body, answer.map, rows::microseconds(answer.kept_at))
      .run();
}

void drop_answers(WriteTransaction& db, Timestamp before, std::size_t most) {
  db.prepare(
        "DELETE FROM kept_answers WHERE rowid IN (SELECT rowid FROM kept_answers WHERE kept_at_us < ? ORDER BY "
        "kept_at_us LIMIT ?)")
      .bind_all(rows::microseconds(before), most)
      .run();
}

void drop_answers_of(WriteTransaction& db, MapId map) {
  db.prepare("DELETE FROM kept_answers WHERE map = ?").bind(1, map).run();
}

void drop_answers_of_deleted_maps(WriteTransaction& db) {
  db.prepare("DELETE FROM kept_answers WHERE map NOT IN (SELECT id FROM maps)").run();
}

}  // namespace mapweld
