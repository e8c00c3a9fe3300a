#include "schema/key_store.h"

#include <filesystem>
#include <fstream>
#include <set>

#include <gtest/gtest.h>

#include "schema/engine/row_checksums.h"
#include "tests/support/temp_store.h"

namespace mapweld {
namespace {

using mapweld::test::at;
using mapweld::test::TempFolder;

KeyRow key(const std::string& name, std::uint8_t byte) {
  KeyRow row;
  row.name = name;
  row.role = "write";
  row.maps = "lab-*";
  row.sha256.fill(byte);
  row.created_at = at(5);
  return row;
}

class KeyStoreTest : public ::testing::Test {
 protected:
  TempFolder folder_;
};

TEST_F(KeyStoreTest, KeepsKeysOverAnOpening) {
  EXPECT_TRUE(KeyStore(folder_.path()).add(key("robot", 1)));
  const std::vector<KeyRow> keys = KeyStore(folder_.path()).list();
  ASSERT_EQ(keys.size(), 1u);
  EXPECT_EQ(keys[0].name, "robot");
  EXPECT_EQ(keys[0].role, "write");
  EXPECT_EQ(keys[0].maps, "lab-*");
  EXPECT_EQ(keys[0].sha256, key("robot", 1).sha256);
  EXPECT_EQ(keys[0].created_at, at(5));
  EXPECT_FALSE(keys[0].revoked_at);
}

TEST_F(KeyStoreTest, ANameIsOneKeysUntilThatIsRevoked) {
  KeyStore keys(folder_.path());
  EXPECT_TRUE(keys.add(key("robot", 1)));
  EXPECT_FALSE(keys.add(key("robot", 2)));
  EXPECT_TRUE(keys.revoke("robot", at(9)));
  EXPECT_FALSE(keys.revoke("robot", at(9)));
  EXPECT_FALSE(keys.revoke("nobody", at(9)));
  EXPECT_TRUE(keys.add(key("robot", 2)));
  ASSERT_EQ(keys.list().size(), 2u);
  EXPECT_EQ(keys.list()[0].revoked_at, at(9));
  EXPECT_FALSE(keys.list()[1].revoked_at);
}

TEST_F(KeyStoreTest, SeesWhatAnotherHasChanged) {
  KeyStore server(folder_.path(), 0);
  KeyStore command(folder_.path());
  const std::int64_t before = server.version();
  EXPECT_EQ(server.version(), before);
  command.add(key("robot", 1));
  const std::int64_t added = server.version();
  EXPECT_NE(added, before);
  EXPECT_EQ(server.list().size(), 1u);
  EXPECT_EQ(server.version(), added);
  command.revoke("robot", at(9));
  EXPECT_NE(server.version(), added);
}

TEST_F(KeyStoreTest, KeysOfBeforeGetNumbersThatAreNeverGivenAgain) {
  {
    sqlite::Connection older(folder_.path() / "keys.db", sqlite::OpenMode::kCreate);
    older.execute(R"sql(
      CREATE TABLE keys (name TEXT NOT NULL, role TEXT NOT NULL CHECK (role IN ('read', 'write', 'operate', 'admin')),
        maps TEXT NOT NULL, sha256 BLOB NOT NULL UNIQUE CHECK (length(sha256) = 32), created_at_us INTEGER NOT NULL,
        revoked_at_us INTEGER, checksum INTEGER NOT NULL DEFAULT 0x7FFFFFFFFFFFFFFF) STRICT;
      CREATE UNIQUE INDEX keys_in_force ON keys (name) WHERE revoked_at_us IS NULL;
      PRAGMA user_version = 2)sql");
    older.execute("PRAGMA application_id = " + std::to_string(kKeysApplicationId));
    keep_row_checksums(older);
    older.execute(
        "INSERT INTO keys (name, role, maps, sha256, created_at_us) VALUES ('late', 'read', '*', zeroblob(32), 9), "
        "('early', 'admin', '*', randomblob(32), 5)");
  }
  KeyStore keys(folder_.path());
  ASSERT_EQ(keys.list().size(), 2u);
  EXPECT_EQ(keys.list()[0].name, "early");
  EXPECT_EQ(keys.list()[0].role, "admin");
  EXPECT_TRUE(keys.add(key("newest", 1)));
  std::set<std::int64_t> ids;
  for (const KeyRow& one : keys.list()) {
    EXPECT_GT(one.id, 0);
    ids.insert(one.id);
  }
  EXPECT_EQ(ids.size(), 3u);
  check_keys(folder_.path(), [](const Finding& finding) { ADD_FAILURE() << finding.where << ": " << finding.what; });
}

// What a key owns stands beside the maps, and in their backups: a key of another file must own nothing of it.
TEST_F(KeyStoreTest, AnotherFileGivesOtherNumbers) {
  std::set<std::int64_t> ids;
  for (int file = 0; file < 5; ++file) {
    KeyStore keys(folder_.path());
    EXPECT_TRUE(keys.add(key("robot", 1)));
    ids.insert(keys.list()[0].id);
    std::filesystem::remove(folder_.path() / "keys.db");
  }
  EXPECT_EQ(ids.size(), 5u);
}

TEST_F(KeyStoreTest, IsItsOwnersOnly) {
  namespace fs = std::filesystem;
  const fs::path folder = folder_.path() / "above" / "data";
  KeyStore(folder).add(key("robot", 1));
  EXPECT_EQ(fs::status(folder).permissions(), fs::perms::owner_all);
  EXPECT_EQ(fs::status(folder / "keys.db").permissions(), fs::perms::owner_read | fs::perms::owner_write);
}

TEST_F(KeyStoreTest, AForeignDatabaseIsLeftAlone) {
  { sqlite::Connection(folder_.path() / "keys.db", sqlite::OpenMode::kCreate).execute("CREATE TABLE recipes (a)"); }
  try {
    const KeyStore keys(folder_.path());
    FAIL() << "opened another application's database";
  } catch (const StoreError& error) {
    EXPECT_EQ(error.kind(), StoreErrorKind::kForeignDatabase);
  }
}

}  // namespace
}  // namespace mapweld
