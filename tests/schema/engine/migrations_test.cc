#include "schema/engine/migrations.h"

#include <vector>

#include <gtest/gtest.h>

#include "tests/support/temp_store.h"

namespace mapweld {
namespace {

class MigrationsTest : public testing::Test {
 protected:
  std::int64_t version() { return connection_.query_integer("PRAGMA user_version"); }
  std::int64_t tables() { return connection_.query_integer("SELECT count(*) FROM sqlite_schema WHERE type = 'table'"); }
  test::TempFolder folder_;
  sqlite::Connection connection_{folder_.path() / "a.db", sqlite::OpenMode::kCreate};
};

const std::vector<Migration> kSteps = {
    {1, "0001_one", "CREATE TABLE a (i INTEGER PRIMARY KEY) STRICT; INSERT INTO a VALUES (1), (2)"},
    {2, "0002_two", "CREATE TABLE b (a INTEGER REFERENCES a (i)) STRICT; INSERT INTO b VALUES (1)"},
    {3, "0003_three", "ALTER TABLE a ADD COLUMN t TEXT"}};

TEST_F(MigrationsTest, TheProgramsOwnAreNumberedWithoutGapsAndMakeStrictTables) {
  int expected = 0;
  for (const Migration& step : migrations()) EXPECT_EQ(step.version, ++expected);
  EXPECT_EQ(migrate(connection_, migrations()), 0);
  EXPECT_EQ(version(), schema_version());
  EXPECT_EQ(connection_.query_integer("SELECT count(*) FROM pragma_table_list WHERE schema = 'main' AND NOT strict AND "
                                      "name NOT LIKE 'sqlite_%'"),
            0);
  EXPECT_EQ(connection_.query_integer("PRAGMA application_id"), 0x4D574C44);
}

TEST_F(MigrationsTest, EveryStepIsTakenOnce) {
  EXPECT_EQ(migrate(connection_, std::span(kSteps).first(1)), 0);
  EXPECT_EQ(version(), 1);
  EXPECT_EQ(migrate(connection_, kSteps), 1);
  EXPECT_EQ(version(), 3);
  EXPECT_EQ(migrate(connection_, kSteps), 3);
  EXPECT_EQ(connection_.query_integer("SELECT count(*) FROM a"), 2);
  EXPECT_EQ(connection_.query_integer("PRAGMA foreign_keys"), 1);
}

TEST_F(MigrationsTest, AStepThatFailsLeavesTheVersionBeforeItWhole) {
  std::vector<Migration> steps = kSteps;
  steps[2].sql = "CREATE TABLE c (i INTEGER) STRICT; DROP TABLE a; INSERT INTO nowhere VALUES (1)";
  EXPECT_THROW(migrate(connection_, steps), StoreError);
  EXPECT_EQ(version(), 2);
  EXPECT_EQ(tables(), 2);
  EXPECT_EQ(migrate(connection_, kSteps), 2);
}

TEST_F(MigrationsTest, AStepThatLeavesADanglingReferenceIsUndone) {
  std::vector<Migration> steps = kSteps;
  steps[2].sql = "DELETE FROM a WHERE i = 1";
  try {
    migrate(connection_, steps);
    FAIL();
  } catch (const StoreError& error) {
    EXPECT_EQ(error.kind(), StoreErrorKind::kCorrupt);
  }
  EXPECT_EQ(version(), 2);
  EXPECT_EQ(connection_.query_integer("SELECT count(*) FROM a"), 2);
}

TEST_F(MigrationsTest, ATableMayBeRebuiltUnderItsReferences) {
  std::vector<Migration> steps = kSteps;
  steps[2].sql =
      "CREATE TABLE fresh (i INTEGER PRIMARY KEY, t TEXT NOT NULL DEFAULT '') STRICT;"
      "INSERT INTO fresh (i) SELECT i FROM a; DROP TABLE a; ALTER TABLE fresh RENAME TO a";
  EXPECT_EQ(migrate(connection_, steps), 0);
  EXPECT_EQ(connection_.query_integer("SELECT count(*) FROM b JOIN a ON a.i = b.a"), 1);
}

TEST_F(MigrationsTest, EdgesThatAGuardHadJudgedGetItsConfidence) {
  migrate(connection_, migrations().first(1));
  connection_.execute(R"(
    INSERT INTO vocabularies VALUES (1, 'words', 10, 128, 'sift-u8', 'exact', zeroblob(32), 0, 0);
    INSERT INTO maps (id, uuid, name, kind, vocabulary, parameters, labels, created_at_us) VALUES
      (1, printf('%036d', 1), 'plain', 'map', 1, '{}', '{}', 0), (2, printf('%036d', 2), 'guarded', 'merged', 1, '{}', '{}', 0),
      (3, printf('%036d', 3), 'free', 'merged', 1, '{}', '{}', 0);
    INSERT INTO verifiers VALUES (1, 'v', '{}');
    INSERT INTO merges (id, map, method, seed, parameters, budget, state, phase, created_at_us, updated_at_us) VALUES
      (1, 2, 'spectral', 0, '{"alias_guard":true}', '{}', 'completed', 'done', 0, 0),
      (2, 3, 'quickconnect', 0, '{"alias_guard":false}', '{}', 'completed', 'done', 0, 0);
    INSERT INTO edges (id, map, u, v, votes, matches, inliers, log10_false_alarms, evidence, verifier, confirmed, doubt, job)
      VALUES (1, 1, 0, 1, 1, 1, 1, -9, x'', 1, 1, NULL, NULL), (2, 2, 0, 1, 1, 1, 1, -9, x'', 1, 1, NULL, 1),
             (3, 2, 0, 2, 1, 1, 1, -9, x'', 1, 0, 'unsupported', 1), (4, 3, 0, 1, 1, 1, 1, -9, x'', 1, 1, NULL, 2))");
  migrate(connection_, migrations());
  sqlite::Statement row = connection_.prepare("SELECT confidence FROM edges ORDER BY id");
  std::vector<std::optional<double>> confidences;
  while (row.step()) confidences.push_back(row.optional_real(0));
  EXPECT_EQ(confidences, (std::vector<std::optional<double>>{std::nullopt, 1.0, 0.0, std::nullopt}));
  sqlite::Statement map = connection_.prepare("SELECT unconfirmed FROM maps ORDER BY id");
  std::vector<std::int64_t> unconfirmed;
  while (map.step()) unconfirmed.push_back(map.integer(0));
  EXPECT_EQ(unconfirmed, (std::vector<std::int64_t>{0, 1, 0}));
}

TEST_F(MigrationsTest, OfImagesFromBeforeNothingIsStatic) {
  migrate(connection_, migrations().first(4));
  connection_.execute(R"(
    INSERT INTO vocabularies VALUES (1, 'words', 10, 128, 'sift-u8', 'exact', zeroblob(32), 0, 0);
    INSERT INTO maps (id, uuid, name, kind, vocabulary, parameters, labels, created_at_us) VALUES
      (1, printf('%036d', 1), 'plain', 'map', 1, '{}', '{}', 0);
    INSERT INTO images (map, vertex, name, sha256, media_type, width_px, height_px, features, reason, uploaded_at_us)
      VALUES (1, 0, 'a', zeroblob(32), 'image/png', 320, 240, 30, '', 0))");
  migrate(connection_, migrations());
  EXPECT_EQ(connection_.query_integer("SELECT static_features FROM images"), 0);
  connection_.execute("UPDATE images SET static_features = 30");
  EXPECT_THROW(connection_.execute("UPDATE images SET static_features = 31"), StoreError);
}

TEST_F(MigrationsTest, ANewerDatabaseIsRefusedAndStaysAsItIs) {
  migrate(connection_, kSteps);
  try {
    migrate(connection_, std::span(kSteps).first(2));
    FAIL();
  } catch (const StoreError& error) {
    EXPECT_EQ(error.kind(), StoreErrorKind::kNewerVersion);
  }
  EXPECT_EQ(version(), 3);
}

}  // namespace
}  // namespace mapweld
