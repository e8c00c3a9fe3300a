#include "schema/key_store.h"

#include <filesystem>
#include <fstream>

#include <gtest/gtest.h>

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
