#include "server/commands/backup.h"

#include <atomic>
#include <fstream>
#include <string>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "schema/maps/edge_store.h"
#include "schema/maps/vertex_store.h"
#include "tests/server/commands/run_command.h"
#include "tests/support/temp_store.h"

namespace mapweld::test {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

Ran run(const std::string& line) { return run_command(server::add_backup_commands, line); }

// A map of 20 vertices.
MapId add_filled_map(TempStore& store, VocabularyId vocabulary, int features) {
  const MapId map = add_map(store, "a", vocabulary);
  Random random(3);
  for (int i = 0; i < 20; ++i) {
    add_vertex(store, map, vocabulary, std::to_string(i), random_appearances(random, features, 1'000));
  }
  return map;
}

TEST(BackupCommand, WhatWasThereIsThereAgainThoughTheServerGoesOn) {
  TempStore store;
  const TempFolder out;
  const VocabularyId vocabulary = add_vocabulary(store);
  const MapId map = add_filled_map(store, vocabulary, 30);
  std::atomic<bool> stop = false;
  std::thread writer([&] {
    Random random(4);
    for (int i = 20; !stop; ++i) {
      add_vertex(store, map, vocabulary, std::to_string(i), random_appearances(random, 30, 1'000));
    }
  });
  const std::string data = (store.folder() / "data").string();
  const std::string file = (out.path() / "copy").string();
  const Ran saved = run("backup --data " + data + " " + file);
  stop = true;
  writer.join();
  EXPECT_EQ(saved.exit_code, 0) << saved.errors;
  EXPECT_EQ(fs::status(file).permissions(), fs::perms::owner_read | fs::perms::owner_write);

  const std::string restored = (out.path() / "new" / "data").string();
  const Ran loaded = run("restore --data " + restored + " " + file);
  EXPECT_EQ(loaded.exit_code, 0) << loaded.errors;
  EXPECT_THAT(loaded.output, HasSubstr("1 maps"));
  EXPECT_THAT(loaded.output, HasSubstr("all in order"));
  DataFolder again(restored);
  const ReadTransaction there = again.store().read();
  const ReadTransaction here = store.read();
  const std::uint32_t vertices = find_map(there, map)->vertices;
  EXPECT_GE(vertices, 20u);
  for (std::uint32_t v = 0; v < vertices; ++v) {
    EXPECT_EQ(find_vertex(there, map, VertexId{v})->sha256, find_vertex(here, map, VertexId{v})->sha256);
  }
}

TEST(BackupCommand, NothingIsOverwritten) {
  TempStore store;
  const TempFolder out;
  add_vocabulary(store);
  const std::string data = (store.folder() / "data").string();
  const std::string file = (out.path() / "copy").string();
  ASSERT_EQ(run("backup --data " + data + " " + file).exit_code, 0);
  EXPECT_EQ(run("backup --data " + data + " " + file).exit_code, 2);

  const std::string restored = (out.path() / "data").string();
  ASSERT_EQ(run("restore --data " + restored + " " + file).exit_code, 0);
  const Ran again = run("restore --data " + restored + " " + file);
  EXPECT_EQ(again.exit_code, 2);
  EXPECT_THAT(again.errors, HasSubstr("there already"));
  EXPECT_EQ(run("restore --data " + data + " " + file).exit_code, 2) << "a server is running there";
}

TEST(BackupCommand, WhatIsNoBackupIsRefusedAndWhatIsDamagedIsTold) {
  TempStore store;
  const TempFolder out;
  add_filled_map(store, add_vocabulary(store), 300);
  const std::string text = (out.path() / "text").string();
  std::ofstream(text) << "no database at all, but long enough to have the header of one: " << std::string(200, 'x');
  EXPECT_EQ(run("restore --data " + (out.path() / "a").string() + " " + text).exit_code, 2);
  EXPECT_EQ(run("restore --data " + (out.path() / "a").string() + " " + text + ".not").exit_code, 2);
  EXPECT_FALSE(fs::exists(out.path() / "a" / "mapweld.db"));

  const std::string file = (out.path() / "copy").string();
  ASSERT_EQ(run("backup --data " + (store.folder() / "data").string() + " " + file).exit_code, 0);
  std::fstream damage(file, std::ios::in | std::ios::out | std::ios::binary);
  // The end of pages, where rows are whatever else is empty.
  const auto pages = static_cast<std::streamoff>(fs::file_size(file) / 4096);
  for (std::streamoff page = pages / 2; page < pages; page += 7) {
    damage.seekp(page * 4096 + 4096 - 64);
    damage << std::string(64, '\x5A');
  }
  damage.close();
  EXPECT_EQ(run("restore --data " + (out.path() / "b").string() + " " + file).exit_code, 1);
}

}  // namespace
}  // namespace mapweld::test
