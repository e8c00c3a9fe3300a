#include "server/services/vocabulary_service.h"

#include <fstream>

#include <gtest/gtest.h>

#include "client/contract/problem.h"
#include "tests/server/support/services_under_test.h"
#include "tests/server/support/test_photos.h"

namespace mapweld::test {
namespace {

TEST(VocabularyService, TellsWhatThereIs) {
  ServicesUnderTest services;
  const contract::Vocabulary words = services.vocabularies().get("words");
  EXPECT_EQ(words.words, 512);
  EXPECT_EQ(words.dimension, 128);
  EXPECT_EQ(words.descriptor, "sift");
  EXPECT_EQ(words.index, "exact");
  EXPECT_EQ(words.sha256.size(), 64u);
  services.vocabularies().add("other", small_vocabulary().serialize());
  const auto first = services.vocabularies().list(1, std::nullopt);
  ASSERT_EQ(first.items.size(), 1u);
  EXPECT_EQ(first.items[0], words);
  const auto second = services.vocabularies().list(1, first.next_cursor);
  EXPECT_EQ(second.items.at(0).name, "other");
  EXPECT_EQ(second.next_cursor, std::nullopt);
}

TEST(VocabularyService, OneThatNobodyUsesCanGo) {
  ServicesUnderTest services;
  const auto remove = [&](const std::string& name) { return code_of([&] { services.vocabularies().remove(name); }); };
  services.create_map("a");
  EXPECT_EQ(remove("words"), "vocabulary_in_use");
  EXPECT_EQ(remove("nothing"), "no_such_vocabulary");
  services.upload("a", "0", photo_jpeg(1, 0));  // it is there as before
  services.maps().remove("a");
  services.vocabularies().add("other", small_vocabulary().serialize());
  EXPECT_EQ(remove("words"), "none");
  EXPECT_EQ(remove("words"), "no_such_vocabulary");
  services.create_map("b");  // the default is the one that is left
  EXPECT_EQ(services.maps().get("b").vocabulary, "other");
  services.maps().remove("b");
  EXPECT_EQ(remove("other"), "none");
  EXPECT_EQ(code_of([&] { services.create_map("c"); }), "no_such_vocabulary");
  EXPECT_EQ(services.store().read().connection().query_integer("SELECT count(*) FROM vocabulary_chunks"), 0);
  services.vocabularies().add("words", small_vocabulary().serialize());  // its name is free again
  services.create_map("c");
}

TEST(VocabularyService, BrokenFilesChangeNothing) {
  ServicesUnderTest services;
  const std::string stored = dump_store(services.store());
  std::vector<std::uint8_t> file = small_vocabulary().serialize();
  const auto code = [&](const std::string& name, std::span<const std::uint8_t> bytes) {
    return code_of([&] { services.vocabularies().add(name, bytes); });
  };
  EXPECT_EQ(code("words", file), "name_taken");
  EXPECT_EQ(code("no slug", file), "invalid_name");
  EXPECT_EQ(code("x", std::span(file).first(file.size() / 2)), "invalid_vocabulary");
  EXPECT_EQ(code("x", {}), "invalid_vocabulary");
  file[file.size() / 2] ^= 1;
  EXPECT_EQ(code("x", file), "invalid_vocabulary");
  EXPECT_EQ(code_of([&] { services.vocabularies().get("x"); }), "no_such_vocabulary");
  EXPECT_EQ(dump_store(services.store()), stored);
}

TEST(VocabularyService, AFileOnTheCommandLineIsTakenInOnce) {
  ServicesUnderTest services;
  const TempFolder folder;
  const auto path = folder.path() / "place-512.mwv";
  {
    // Other words, so that the content is not known yet.
    std::vector<std::uint8_t> centroids(small_vocabulary().centroids().begin(), small_vocabulary().centroids().end());
    centroids[0] ^= 1;
    WordIndexOptions options;
    options.engine = "exact";
    const auto file = Vocabulary(std::move(centroids), options).serialize();
    std::ofstream(path, std::ios::binary)
        .write(reinterpret_cast<const char*>(file.data()), static_cast<std::streamsize>(file.size()));
  }
  services.vocabularies().set_default(path);
  services.vocabularies().set_default(path);
  EXPECT_EQ(services.vocabularies().list(10, std::nullopt).items.size(), 2u);
  services.create_map("lab");
  EXPECT_EQ(services.maps().get("lab").vocabulary, "place-512");
  EXPECT_THROW(services.vocabularies().set_default(folder.path() / "missing.mwv"), std::runtime_error);
  std::ofstream(folder.path() / "text.mwv") << "hello";
  EXPECT_THROW(services.vocabularies().set_default(folder.path() / "text.mwv"), std::runtime_error);
}

}  // namespace
}  // namespace mapweld::test
