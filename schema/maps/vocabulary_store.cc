#include "schema/maps/vocabulary_store.h"

#include <algorithm>

#include "schema/rows.h"

namespace mapweld {
namespace {

constexpr std::size_t kChunkBytes = std::size_t{1} << 20;

constexpr std::string_view kColumns =
    "SELECT id, name, words, dimension, descriptor, engine, sha256, file_bytes, created_at_us FROM vocabularies ";

VocabularyRow read_row(const sqlite::Statement& row) {
  VocabularyRow vocabulary;
  vocabulary.id = row.id<VocabularyId>(0);
  vocabulary.name = row.text(1);
  vocabulary.words = static_cast<std::uint32_t>(row.integer(2));
  vocabulary.dimension = static_cast<int>(row.integer(3));
  vocabulary.descriptor = row.text(4);
  vocabulary.engine = row.text(5);
  vocabulary.sha256 = rows::sha256(row, 6);
  vocabulary.file_bytes = static_cast<std::uint64_t>(row.integer(7));
  vocabulary.created_at = rows::timestamp(row, 8);
  return vocabulary;
}

}  // namespace

VocabularyId insert_vocabulary(WriteTransaction& db, const NewVocabulary& vocabulary,
                               std::span<const std::uint8_t> file) {
  db.prepare(
        "INSERT INTO vocabularies (name, words, dimension, descriptor, engine, sha256, file_bytes, created_at_us) "
        "VALUES (?, ?, ?, ?, ?, ?, ?, ?)")
      .bind_all(vocabulary.name, vocabulary.words, vocabulary.dimension, vocabulary.descriptor, vocabulary.engine,
                std::span<const std::uint8_t>(vocabulary.sha256), file.size(),
                rows::microseconds(vocabulary.created_at))
      .run();
  const VocabularyId id{db.connection().last_insert_rowid()};
  sqlite::Statement insert = db.prepare("INSERT INTO vocabulary_chunks (vocabulary, chunk, bytes) VALUES (?, ?, ?)");
  for (std::size_t at = 0, chunk = 0; at < file.size(); at += kChunkBytes, ++chunk) {
    insert.bind_all(id, chunk, file.subspan(at, std::min(kChunkBytes, file.size() - at))).run();
  }
  return id;
}

std::optional<VocabularyRow> find_vocabulary(const Reader& db, std::string_view name) {
  sqlite::Statement row = db.prepare(std::string(kColumns) + "WHERE name = ?");
  if (!row.bind(1, name).step()) return std::nullopt;
  return read_row(row);
}

std::optional<VocabularyRow> find_vocabulary(const Reader& db, VocabularyId id) {
  sqlite::Statement row = db.prepare(std::string(kColumns) + "WHERE id = ?");
  if (!row.bind(1, id).step()) return std::nullopt;
  return read_row(row);
}

std::vector<VocabularyRow> list_vocabularies(const Reader& db, std::size_t limit, std::optional<VocabularyId> after) {
  sqlite::Statement row = db.prepare(std::string(kColumns) + "WHERE id > ? ORDER BY id LIMIT ?");
  row.bind_all(after.value_or(VocabularyId{0}), limit);
  std::vector<VocabularyRow> vocabularies;
  while (row.step()) vocabularies.push_back(read_row(row));
  return vocabularies;
}

bool delete_vocabulary(WriteTransaction& db, VocabularyId id) {
  if (db.prepare("SELECT 1 FROM maps WHERE vocabulary = ? LIMIT 1").bind(1, id).step()) return false;
  db.prepare("DELETE FROM vocabularies WHERE id = ?").bind(1, id).run();  // its file by cascade
  return true;
}

std::vector<std::uint8_t> load_vocabulary_file(const Reader& db, VocabularyId id) {
  const auto vocabulary = find_vocabulary(db, id);
  std::vector<std::uint8_t> file;
  if (vocabulary) file.reserve(vocabulary->file_bytes);
  sqlite::Statement row = db.prepare("SELECT bytes FROM vocabulary_chunks WHERE vocabulary = ? ORDER BY chunk");
  row.bind(1, id);
  while (row.step()) file.insert(file.end(), row.blob(0).begin(), row.blob(0).end());
  if (!vocabulary || file.size() != vocabulary->file_bytes) {
    throw StoreError(StoreErrorKind::kCorrupt,
                     "vocabulary " + std::to_string(to_index(id)) + ": a piece of its file is missing");
  }
  return file;
}

}  // namespace mapweld
