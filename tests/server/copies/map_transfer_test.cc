// Maps that go from one server to another: the copy is the original, and what strangers send is believed in nothing.
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <regex>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "schema/engine/database.h"
#include "schema/engine/row_checksums.h"
#include "schema/store_check.h"
#include "tests/server/support/api_under_test.h"
#include "tests/server/support/test_photos.h"

namespace mapweld::test {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

class MapTransferTest : public ::testing::Test {
 protected:
  // A loop of photographs, one ignored, and another map between, so that numbers of rows differ from what they would
  // be.
  void fill() {
    here_.post("/v1/maps", R"({"name":"other"})");
    here_.post("/v1/maps", R"({"name":"a","labels":{"robot":"p3at"},"parameters":{"verify_top":7}})");
    for (int step = 0; step < 5; ++step) {
      here_.post_image("/v1/maps/a/images?name=n" + std::to_string(step), photo_jpeg(1, step));
      here_.post_image("/v1/maps/other/images?name=o" + std::to_string(step), photo_jpeg(2, step));
    }
    here_.post_image("/v1/maps/a/images?name=again&sequence=lap-2&index=7", photo_jpeg(1, 2));
  }
  Answer import(const std::string& query, const std::string& bytes) {
    return there_.post("/v1/maps:import" + query, bytes, "application/vnd.sqlite3");
  }
  // What a server says of a map, but for what names it and its row.
  static std::string said(const ApiUnderTest& api, const std::string& map) {
    std::string all;
    for (const char* path : {"/vertices", "/ignored", "/edges", "/graph", "/quality", "/pairs/0/1?matches=true"}) {
      all += api.get("/v1/maps/" + map + path).body + "\n";
    }
    for (int vertex = 0; vertex < 5; ++vertex) {
      const Answer image = api.get("/v1/maps/" + map + "/vertices/" + std::to_string(vertex) + "/image");
      all += image.status == 200 ? image.body : image.code();
    }
    for (const int step : {1, 3, 9}) {
      contract::Json found = api.post_image("/v1/maps/" + map + "/localize", photo_jpeg(1, step)).json();
      found.erase("took_ms");
      all += found.dump();
    }
    return all;
  }
  // The exported file, changed by SQL.
  std::string changed(const std::string& sql) {
    const fs::path file = folder_.path() / "changed";
    std::ofstream(file, std::ios::binary) << here_.get("/v1/maps/a/export").body;
    {
      sqlite::Connection connection(file, sqlite::OpenMode::kReadWrite);
      keep_row_checksums(connection);  // as a stranger can, who has read the source
      connection.execute("PRAGMA foreign_keys = OFF; PRAGMA ignore_check_constraints = ON; " + sql);
    }
    std::ifstream in(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
  }

  ApiUnderTest here_;
  ApiUnderTest there_;
  TempFolder folder_;
};

TEST_F(MapTransferTest, TheCopyAnswersAsTheOriginal) {
  fill();
  there_.post("/v1/maps", R"({"name":"first"})");
  there_.post_image("/v1/maps/first/images?name=x", photo_jpeg(5, 1));
  const Answer exported = here_.get("/v1/maps/a/export");
  ASSERT_EQ(exported.status, 200);
  EXPECT_THAT(exported.header("Content-Disposition"), HasSubstr("a.mapweld"));
  const Answer imported = import("", exported.body);
  ASSERT_EQ(imported.status, 201) << imported.body;
  EXPECT_EQ(imported.header("Location"), "/v1/maps/a");
  contract::Json copy = there_.get("/v1/maps/a").json();
  EXPECT_EQ(copy, here_.get("/v1/maps/a").json());
  std::string original = said(here_, "a");
  EXPECT_TRUE(said(there_, "a") == original);
  EXPECT_TRUE(check_store(there_.services().store().read()).findings.empty());
  // It grows as the original does.
  const std::string next = "/v1/maps/a/images?name=next";
  contract::Json here = here_.post_image(next, photo_jpeg(1, 5)).json();
  contract::Json there = there_.post_image(next, photo_jpeg(1, 5)).json();
  here.erase("took_ms");
  there.erase("took_ms");
  EXPECT_EQ(there, here);
  EXPECT_TRUE(said(there_, "a") == said(here_, "a"));
}

TEST_F(MapTransferTest, TheSameMapGivesTheSameFileInPartsToo) {
  fill();
  const std::string whole = here_.get("/v1/maps/a/export").body;
  std::string parts;
  const std::string etag = here_.get("/v1/maps/a/export").header("ETag");
  while (parts.size() < whole.size()) {
    const std::string range = "bytes=" + std::to_string(parts.size()) + "-" + std::to_string(parts.size() + 99'999);
    const Answer part = here_.ask("GET", "/v1/maps/a/export", {{"Range", range}, {"If-Range", etag}});
    ASSERT_EQ(part.status, 206);
    parts += part.body;
  }
  EXPECT_TRUE(parts == whole);
  for (const auto& entry : fs::directory_iterator(here_.services().store().file().parent_path())) {
    EXPECT_THAT(entry.path().filename().string(), ::testing::Not(HasSubstr("body-")));
  }
}

TEST_F(MapTransferTest, WithoutImagesItIsWordsAndEdges) {
  fill();
  const std::string words = here_.get("/v1/maps/a/export?images=false").body;
  EXPECT_LT(words.size(), here_.get("/v1/maps/a/export").body.size());
  EXPECT_EQ(words.find(photo_jpeg(1, 0).substr(2000, 400)), std::string::npos);
  ASSERT_EQ(import("?name=words", words).status, 201);
  EXPECT_EQ(there_.get("/v1/maps/words/edges").body, here_.get("/v1/maps/a/edges").body);
  EXPECT_EQ(there_.get("/v1/maps/words/vertices/0/image").code(), "no_such_image");
}

TEST_F(MapTransferTest, NamesAndUuidsStayFree) {
  fill();
  const std::string file = here_.get("/v1/maps/a/export").body;
  const std::string uuid = here_.get("/v1/maps/a").json()["uuid"];
  EXPECT_EQ(import("", file).json()["uuid"], uuid);
  EXPECT_EQ(import("", file).code(), "name_taken");
  EXPECT_EQ(import("?name=not%20a%20slug", file).code(), "invalid_name");
  const Answer second = import("?name=b", file);
  EXPECT_EQ(second.status, 201);
  EXPECT_NE(second.json()["uuid"], uuid);
  const std::string said_of_b = std::regex_replace(said(there_, "b"), std::regex(R"("map":"b")"), R"("map":"a")");
  EXPECT_TRUE(said_of_b == said(there_, "a"));
}

TEST_F(MapTransferTest, WhatIsDeletedStaysBehind) {
  fill();
  const std::string bytes = photo_jpeg(1, 4).substr(2000, 400);
  ASSERT_NE(here_.get("/v1/maps/a/export").body.find(bytes), std::string::npos);
  here_.del("/v1/maps/a/vertices/4");
  const std::string file = here_.get("/v1/maps/a/export").body;
  EXPECT_EQ(file.find(bytes), std::string::npos);
  ASSERT_EQ(import("", file).status, 201);
  EXPECT_TRUE(check_store(there_.services().store().read()).findings.empty());
  EXPECT_TRUE(said(there_, "a") == said(here_, "a"));
  EXPECT_EQ(there_.get("/v1/maps/a").json()["vertices"], 4);
  EXPECT_EQ(there_.post("/v1/maps/a/vertices/4/restore", "").code(), "no_such_vertex");
  EXPECT_EQ(there_.post_image("/v1/maps/a/images?name=next", photo_jpeg(1, 5)).json()["vertex"], 5);
}

TEST_F(MapTransferTest, AMergedMapIsExportedByItsMembers) {
  fill();
  here_.post("/v1/merges", R"({"maps":["a","other"],"name":"both"})");
  here_.finished_merge(1);
  EXPECT_EQ(here_.get("/v1/maps/both/export").code(), "map_is_merged");
  EXPECT_EQ(here_.get("/v1/maps/none/export").code(), "no_such_map");
}

TEST_F(MapTransferTest, AVocabularyThatIsNotThereComesAlong) {
  fill();
  const std::string file = here_.get("/v1/maps/a/export").body;
  {
    WriteTransaction db = there_.services().store().write();
    db.prepare("UPDATE vocabularies SET name = 'mine', sha256 = zeroblob(32)").run();
    db.commit();
  }
  ASSERT_EQ(import("", file).status, 201);
  EXPECT_EQ(there_.get("/v1/maps/a").json()["vocabulary"], "words");
  EXPECT_TRUE(said(there_, "a") == said(here_, "a"));
  {
    WriteTransaction db = there_.services().store().write();
    db.prepare("UPDATE vocabularies SET sha256 = zeroblob(32) WHERE name = 'words'").run();
    db.commit();
  }
  EXPECT_EQ(import("?name=b", file).code(), "vocabulary_mismatch");
}

TEST_F(MapTransferTest, WhatStrangersSendIsRefusedAndNothingChanges) {
  fill();
  const std::string before = dump_store(there_.services().store());
  const std::string good = here_.get("/v1/maps/a/export").body;
  EXPECT_EQ(import("", "").code(), "empty_body");
  EXPECT_EQ(import("", "no database").code(), "damaged_file");
  EXPECT_EQ(import("", std::string(100'000, 'x')).code(), "damaged_file");
  EXPECT_EQ(import("", good.substr(0, good.size() / 2)).code(), "damaged_file");
  const std::vector<std::string> hostile = {
      "CREATE TRIGGER t AFTER INSERT ON maps BEGIN DELETE FROM maps; END",
      "CREATE VIEW v AS SELECT 1",
      "CREATE TABLE more (x)",
      "CREATE INDEX more ON images (name)",
      "ALTER TABLE images ADD COLUMN more",
      "PRAGMA application_id = 7",
      "PRAGMA user_version = 1000",
      "PRAGMA user_version = 0",
      "DELETE FROM maps",
      "INSERT INTO maps SELECT id + 1, '00000000-0000-4000-8000-000000000000', 'b', kind, vocabulary, parameters, "
      "labels, "
      "created_at_us, 0, 0, 0, 0, 0, 0 FROM maps",
      "UPDATE maps SET kind = 'merged'",
      "UPDATE maps SET name = '../../etc'",
      "UPDATE maps SET parameters = '{\"verify_top\":-4}'",
      "UPDATE maps SET labels = '[1]'",
      "UPDATE maps SET vertices = 4000000000",
      "UPDATE images SET media_type = 'text/html'",
      "UPDATE images SET name = 'x' || char(10) WHERE vertex = 1",
      "UPDATE images SET width_px = -1",
      "UPDATE images SET id = id + 4611686018427387904",
      "UPDATE images SET vertex = 70 WHERE vertex = 1",
      "UPDATE image_bytes SET bytes = x'00'",
      "UPDATE appearances SET bytes = x'00'",
      "UPDATE edges SET evidence = x'00'",
      "UPDATE edges SET v = 4000000000",
      "UPDATE edges SET confirmed = 0, doubt = 'nonsense'; UPDATE maps SET unconfirmed = edges",
      "UPDATE vocabularies SET words = 4000000000",
      "UPDATE maps SET revision = 9223372036854775807",
      "UPDATE maps SET parameters = '{\"max_features\":20}'",
      "UPDATE images SET sequence = x'ff' WHERE vertex = 1",
      "UPDATE images SET sequence = CAST(x'ff' AS TEXT) WHERE vertex = 1",
      "INSERT INTO segments (map, vocabulary, first_vertex, count, postings) SELECT id, vocabulary, 0, 1, 0 FROM maps",
      "INSERT INTO vocabularies (name, words, dimension, descriptor, engine, sha256, file_bytes, created_at_us) SELECT "
      "'w', words, dimension, descriptor, engine, sha256, 0, 0 FROM vocabularies",
      "DELETE FROM verifiers",
      "DELETE FROM vocabulary_chunks",
  };
  for (const std::string& sql : hostile) {
    std::string file;
    try {
      file = changed(sql);
    } catch (const std::exception&) {
      continue;  // another schema than this list knows
    }
    EXPECT_EQ(import("", file).code(), "damaged_file") << sql;
  }
  EXPECT_EQ(dump_store(there_.services().store()), before);
  EXPECT_EQ(import("", good).status, 201);
}

}  // namespace
}  // namespace mapweld::test
