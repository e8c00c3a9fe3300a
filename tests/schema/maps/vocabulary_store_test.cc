#include "schema/maps/vocabulary_store.h"

#include <gtest/gtest.h>

#include "tests/support/temp_store.h"

namespace mapweld {
namespace {

using test::TempStore;

TEST(VocabularyStore, AVocabularyComesBackAsItWasStored) {
  TempStore store;
  test::Random random(1);
  for (const std::size_t bytes : {1UL, 1UL << 20, (3UL << 20) + 17}) {
    NewVocabulary vocabulary;
    vocabulary.name = "words-" + std::to_string(bytes);
    vocabulary.words = 50'000;
    vocabulary.engine = "flann";
    vocabulary.sha256.fill(static_cast<std::uint8_t>(bytes % 251));
    vocabulary.created_at = test::at(5);
    const auto file = test::random_bytes(random, bytes);
    WriteTransaction db = store.write();
    const VocabularyId id = insert_vocabulary(db, vocabulary, file);
    db.commit();
    store.reopen();

    const ReadTransaction reader = store.read();
    const auto row = find_vocabulary(reader, vocabulary.name);
    ASSERT_TRUE(row);
    EXPECT_EQ(row->id, id);
    EXPECT_EQ(row->words, 50'000U);
    EXPECT_EQ(row->dimension, 128);
    EXPECT_EQ(row->descriptor, "sift-u8");
    EXPECT_EQ(row->engine, "flann");
    EXPECT_EQ(row->sha256, vocabulary.sha256);
    EXPECT_EQ(row->created_at, test::at(5));
    EXPECT_EQ(row->file_bytes, bytes);
    EXPECT_EQ(load_vocabulary_file(reader, id), file);
  }
}

TEST(VocabularyStore, NamesAreUniqueAndListsArePaged) {
  TempStore store;
  for (const char* name : {"c", "a", "b"}) test::add_vocabulary(store, name);
  EXPECT_THROW(test::add_vocabulary(store, "a"), StoreError);
  const ReadTransaction reader = store.read();
  const auto first = list_vocabularies(reader, 2);
  ASSERT_EQ(first.size(), 2U);
  EXPECT_EQ(first[0].name, "c");
  const auto rest = list_vocabularies(reader, 2, first.back().id);
  ASSERT_EQ(rest.size(), 1U);
  EXPECT_EQ(rest[0].name, "b");
  EXPECT_FALSE(find_vocabulary(reader, "d"));
}

TEST(VocabularyStore, AMissingPieceIsTold) {
  TempStore store;
  const VocabularyId id = test::add_vocabulary(store);
  WriteTransaction db = store.write();
  db.connection().execute("DELETE FROM vocabulary_chunks");
  EXPECT_THROW(load_vocabulary_file(db, id), StoreError);
}

}  // namespace
}  // namespace mapweld
