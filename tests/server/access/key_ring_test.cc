#include "server/access/key_ring.h"

#include <filesystem>
#include <fstream>
#include <set>
#include <string>

#include <gtest/gtest.h>

#include "server/access/key.h"
#include "tests/server/access/keys_under_test.h"

namespace mapweld::server {
namespace {

using mapweld::test::KeysUnderTest;

TEST(Key, IsLongAndNeverTheSame) {
  std::set<std::string> keys;
  for (int i = 0; i < 1000; ++i) {
    const std::string key = make_key();
    EXPECT_EQ(key.size(), 3 + 43u);  // 256 bits, 6 a digit
    EXPECT_EQ(key.substr(0, 3), "mw_");
    EXPECT_EQ(key.find_first_not_of("ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789-_"),
              std::string::npos);
    keys.insert(key);
  }
  EXPECT_EQ(keys.size(), 1000u);
}

TEST(Key, IsReadFromItsField) {
  EXPECT_EQ(bearer_key("Bearer mw_a"), "mw_a");
  EXPECT_EQ(bearer_key("bearer mw_a"), "mw_a");
  for (const char* field : {"", "Bearer", "Bearer ", "Basic bXc6YQ==", "mw_a", "Bearer a b", "Bearer a, Bearer b"}) {
    EXPECT_FALSE(bearer_key(field)) << field;
  }
}

TEST(KeyRing, KnowsWhoseAKeyIs) {
  KeysUnderTest keys;
  const std::string robot = keys.make("robot", "write", "lab-*");
  keys.make("other", "read");
  KeyRing ring(keys.folder());
  const KeyRing::Finding found = ring.find(robot);
  EXPECT_TRUE(found.has_keys);
  ASSERT_NE(found.caller, nullptr);
  EXPECT_EQ(found.caller->name, "robot");
  EXPECT_EQ(found.caller->role, Role::kWrite);
  EXPECT_TRUE(found.caller->may_use("lab-a"));
  EXPECT_FALSE(found.caller->may_use("hall"));
  EXPECT_FALSE(found.caller->may_use("my-lab-a"));
  for (const std::string& wrong : {std::string(), robot.substr(0, 45), robot + "A", std::string("mw_")}) {
    EXPECT_EQ(ring.find(wrong).caller, nullptr) << wrong;
  }
}

TEST(KeyRing, WhatIsChangedCountsAtOnce) {
  KeysUnderTest keys;
  KeyRing ring(keys.folder());
  EXPECT_FALSE(ring.find("").has_keys);
  const std::string robot = keys.make("robot", "read");
  EXPECT_NE(ring.find(robot).caller, nullptr);
  keys.revoke("robot");
  EXPECT_EQ(ring.find(robot).caller, nullptr);
}

TEST(KeyRing, TakingBackTheLastKeyDoesNotOpenTheDoor) {
  KeysUnderTest keys;
  keys.make("robot", "read");
  keys.revoke("robot");
  KeyRing ring(keys.folder());
  EXPECT_TRUE(ring.find("").has_keys);
}

TEST(KeyRing, ReadOnlyItSeesKeysThatAreMadeLater) {
  const mapweld::test::TempFolder folder;
  const std::filesystem::path file = folder.path() / "keys.db";
  KeyRing ring(folder.path(), true);
  EXPECT_FALSE(ring.find("").has_keys);
  EXPECT_FALSE(std::filesystem::exists(file));
  std::ofstream(file) << "no keys that could be read";
  EXPECT_TRUE(ring.find("").has_keys) << "the door is not open while nobody can say whose keys there are";
  std::filesystem::remove(file);
  KeysUnderTest keys;
  const std::string robot = keys.make("robot", "read");
  std::filesystem::copy_file(keys.folder() / "keys.db", file);
  ASSERT_NE(ring.find(robot).caller, nullptr);
  EXPECT_EQ(ring.find(robot).caller->name, "robot");
}

TEST(KeyRing, KeysStayInForceWhileTheyAreBeingChanged) {
  KeysUnderTest keys;
  const std::string robot = keys.make("robot", "read");
  KeyRing ring(keys.folder());
  sqlite::Connection writer(keys.folder() / "keys.db", sqlite::OpenMode::kReadWrite);
  writer.execute("BEGIN EXCLUSIVE; UPDATE keys SET revoked_at_us = 5");
  EXPECT_NE(ring.find(robot).caller, nullptr);
  writer.execute("COMMIT");
  EXPECT_EQ(ring.find(robot).caller, nullptr);
}

}  // namespace
}  // namespace mapweld::server
