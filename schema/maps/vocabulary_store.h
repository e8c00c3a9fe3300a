// Table `vocabularies`: the visual vocabularies that maps quantise with. Never changed once stored.
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

struct NewVocabulary {
  std::string name;  // slug, unique
  std::uint32_t words = 0;
  int dimension = kDescriptorDimension;
  std::string descriptor = "sift-u8";  // what the words are made of
  std::string engine;                  // of its index: "hnsw", "flann", "exact"
  Sha256 sha256{};                     // of the file's bytes
  Timestamp created_at;
};

struct VocabularyRow : NewVocabulary {
  VocabularyId id{};
  std::uint64_t file_bytes = 0;
};

// Stores a vocabulary and the bytes of its file (Vocabulary::serialize). The name must be free: ask find_vocabulary in
// the same transaction first.
VocabularyId insert_vocabulary(WriteTransaction& db, const NewVocabulary& vocabulary,
                               std::span<const std::uint8_t> file);

std::optional<VocabularyRow> find_vocabulary(const Reader& db, std::string_view name);
std::optional<VocabularyRow> find_vocabulary(const Reader& db, VocabularyId id);

// Up to `limit` vocabularies in order of id, those after `after`.
std::vector<VocabularyRow> list_vocabularies(const Reader& db, std::size_t limit,
                                             std::optional<VocabularyId> after = {});

// Deletes a vocabulary with its file. False, and nothing changed, while a map is made with it.
bool delete_vocabulary(WriteTransaction& db, VocabularyId id);

// The file as it was stored. Throws kCorrupt when a piece is missing.
std::vector<std::uint8_t> load_vocabulary_file(const Reader& db, VocabularyId id);

}  // namespace mapweld
