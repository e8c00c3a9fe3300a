#include "schema/store.h"

#include <atomic>
#include <chrono>
#include <optional>
#include <thread>

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>

#include "schema/segments/segment_store.h"
#include "schema/store_check.h"
#include "tests/support/temp_store.h"

namespace mapweld {
namespace {

using test::Random;
using test::TempStore;

TEST(Store, IsKeptAsTheContractAsks) {
  TempStore store;
  const WriteTransaction db = store.write();
  EXPECT_EQ(db.prepare("PRAGMA journal_mode").step(), true);
  sqlite::Statement mode = db.prepare("PRAGMA journal_mode");
  mode.step();
  EXPECT_EQ(mode.text(0), "wal");
  EXPECT_EQ(db.connection().query_integer("PRAGMA synchronous"), 2);  // FULL
  EXPECT_EQ(db.connection().query_integer("PRAGMA foreign_keys"), 1);
  EXPECT_EQ(db.connection().query_integer("PRAGMA wal_autocheckpoint"), 0);
  const ReadTransaction reader = store.read();
  EXPECT_EQ(reader.connection().query_integer("PRAGMA query_only"), 1);
  EXPECT_EQ(reader.connection().query_integer("PRAGMA wal_autocheckpoint"), 0);
}

TEST(Store, AReaderSeesOneStateHoweverMuchIsWritten) {
  TempStore store;
  test::add_vocabulary(store, "first");
  const ReadTransaction before = store.read();
  test::add_vocabulary(store, "second");
  EXPECT_EQ(list_vocabularies(before, 10).size(), 1U);
  EXPECT_EQ(list_vocabularies(store.read(), 10).size(), 2U);
}

TEST(Store, ASnapshotIsTakenWhenItBeginsNotWhenItFirstReads) {
  TempStore store;
  const ReadTransaction before = store.read();
  test::add_vocabulary(store, "first");
  EXPECT_TRUE(list_vocabularies(before, 10).empty());
}

TEST(Store, AWriterThatGivesUpLeavesNothingAndLetsTheNextIn) {
  TempStore store;
  {
    WriteTransaction db = store.write();
    db.connection().execute("INSERT INTO meta (key, value) VALUES ('a', 'b')");
  }
  WriteTransaction db = store.write();
  EXPECT_EQ(db.connection().query_integer("SELECT count(*) FROM meta WHERE key = 'a'"), 0);
  db.rollback();
  db.rollback();
  EXPECT_THROW(db.commit(), StoreError);
  store.write().commit();
}

// Each writer adds vertices to a map of its own; each reader checks that what it sees agrees with itself.
TEST(Store, ReadersAndWritersGoOnAtOnce) {
  StoreOptions options;
  options.checkpoint_pages = 20;  // the WAL is moved all the time
  options.restart_pages = 60;
  TempStore store(options);
  const VocabularyId vocabulary = test::add_vocabulary(store);
  constexpr int kWriters = 3;
  constexpr int kReaders = 4;
  constexpr int kVertices = 60;
  std::vector<MapId> maps;
  for (int w = 0; w < kWriters; ++w) maps.push_back(test::add_map(store, "map-" + std::to_string(w), vocabulary));
  std::atomic<int> writing = kWriters;
  std::atomic<int> reads = 0;
  std::vector<std::thread> threads;
  for (int w = 0; w < kWriters; ++w) {
    threads.emplace_back([&, w] {
      Random random(static_cast<std::uint64_t>(w));
      for (int i = 0; i < kVertices; ++i) {
        test::add_vertex(store, maps[static_cast<std::size_t>(w)], vocabulary, std::to_string(i),
                         test::random_appearances(random, 30, 1'000));
      }
      --writing;
    });
  }
  for (int r = 0; r < kReaders; ++r) {
    threads.emplace_back([&, r] {
      while (writing > 0 || reads < kReaders) {
        const ReadTransaction reader = store.read();
        const MapId map = maps[static_cast<std::size_t>(r % kWriters)];
        const auto row = find_map(reader, map);
        ASSERT_TRUE(row);
        EXPECT_EQ(load_index(reader, map, vocabulary).vertices(), row->vertices);
        EXPECT_EQ(list_vertices(reader, load_layout(reader, map), 1'000).size(), row->vertices);
        ++reads;
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  const ReadTransaction reader = store.read();
  for (const MapId map : maps) EXPECT_EQ(find_map(reader, map)->vertices, static_cast<std::uint32_t>(kVertices));
  EXPECT_TRUE(check_store(reader).findings.empty());
  const StoreStatistics statistics = store.store().statistics();
  EXPECT_GT(statistics.wal_checkpoints, 10U);
  EXPECT_EQ(statistics.failed_wal_checkpoints, 0U) << statistics.last_wal_checkpoint_error;
}

TEST(Store, WithoutFileDescriptorsItSaysSoAndGoesOnLater) {
  TempStore store;
  test::add_vocabulary(store);
  rlimit before{};
  ASSERT_EQ(::getrlimit(RLIMIT_NOFILE, &before), 0);
  const int next = ::dup(0);
  ::close(next);
  rlimit few = before;
  few.rlim_cur = static_cast<rlim_t>(next) + 2;
  std::vector<ReadTransaction> readers;
  std::string told;
  ASSERT_EQ(::setrlimit(RLIMIT_NOFILE, &few), 0);
  try {
    while (readers.size() < 10) readers.push_back(store.read());
  } catch (const StoreError& error) {
    told = to_string(error.kind());
  }
  ASSERT_EQ(::setrlimit(RLIMIT_NOFILE, &before), 0);
  EXPECT_EQ(told, "no_resources");
  readers.clear();
  EXPECT_NO_THROW(store.read());
}

TEST(Store, TheWalStartsOverThoughThereIsAlwaysSomeReader) {
  StoreOptions options;
  options.checkpoint_pages = 50;
  options.restart_pages = 200;
  TempStore store(options);
  const VocabularyId vocabulary = test::add_vocabulary(store);
  const MapId map = test::add_map(store, "a", vocabulary);
  std::atomic<bool> stop = false;
  std::vector<std::thread> readers;
  for (int r = 0; r < 4; ++r) {
    readers.emplace_back([&] {
      while (!stop) {
        const ReadTransaction reader = store.read();
        std::this_thread::sleep_for(std::chrono::milliseconds(2));
      }
    });
  }
  Random random(1);
  std::uint64_t written = 0;
  std::uint32_t most_pages = 0;
  std::uint32_t before = 0;
  for (int i = 0; i < 400; ++i) {
    test::add_vertex(store, map, vocabulary, std::to_string(i), test::random_appearances(random, 100, 1'000));
    const std::uint32_t pages = store.store().statistics().wal_pages;
    written += pages >= before ? pages - before : pages;
    before = pages;
    most_pages = std::max(most_pages, pages);
  }
  stop = true;
  for (std::thread& reader : readers) reader.join();
  EXPECT_GT(written, 2'000U);
  EXPECT_LT(most_pages, written / 2);
}

TEST(Store, AReaderThatStaysDoesNotMakeEveryCommitMoveTheWal) {
  StoreOptions options;
  options.checkpoint_pages = 50;
  TempStore store(options);
  const VocabularyId vocabulary = test::add_vocabulary(store);
  const MapId map = test::add_map(store, "a", vocabulary);
  const ReadTransaction stays = store.read();
  Random random(1);
  for (int i = 0; i < 100; ++i) {
    test::add_vertex(store, map, vocabulary, std::to_string(i), test::random_appearances(random, 100, 1'000));
  }
  const StoreStatistics statistics = store.store().statistics();
  EXPECT_GE(statistics.wal_checkpoints, statistics.wal_pages / 50 / 2);
  EXPECT_LE(statistics.wal_checkpoints, statistics.wal_pages / 50 + 1);
}

TEST(Store, ABackupIsOneStateTakenWhileOthersWrite) {
  TempStore store;
  const VocabularyId vocabulary = test::add_vocabulary(store);
  const MapId map = test::add_map(store, "a", vocabulary);
  std::atomic<bool> stop = false;
  std::atomic<std::uint32_t> written = 0;
  std::thread writer([&] {
    Random random(1);
    while (!stop) {
      test::add_vertex(store, map, vocabulary, std::to_string(written), test::random_appearances(random, 50, 1'000));
      ++written;
    }
  });
  const test::TempFolder target;
  while (written < 20) std::this_thread::yield();
  const std::uint32_t at_least = written;
  store.store().backup(target.path() / "mapweld.db");
  const std::uint32_t at_most = written + 1;
  EXPECT_THROW(store.store().backup(target.path() / "mapweld.db"), StoreError);
  stop = true;
  writer.join();

  DataFolder copy(target.path());
  const ReadTransaction reader = copy.store().read();
  EXPECT_TRUE(check_store(reader).findings.empty());
  const std::uint32_t vertices = find_map(reader, map)->vertices;
  EXPECT_GE(vertices, at_least);
  EXPECT_LE(vertices, at_most);
}

// A full disk, played by the limit on pages: SQLite answers both with SQLITE_FULL.
TEST(Store, WithoutSpaceNothingStoredChangesAndTheStoreGoesOn) {
  TempStore store;
  const VocabularyId vocabulary = test::add_vocabulary(store);
  const MapId map = test::add_map(store, "a", vocabulary);
  const MapId old = test::add_map(store, "old", vocabulary);
  Random random(1);
  const AppearanceVector appearances = test::random_appearances(random, 400, 1'000);
  for (int i = 0; i < 50; ++i) test::add_vertex(store, old, vocabulary, std::to_string(i), appearances);
  store.store().limit_pages(
      static_cast<std::uint32_t>(store.read().connection().query_integer("PRAGMA page_count") + 100));

  std::uint32_t acknowledged = 0;
  int refused = 0;
  for (int i = 0; i < 200; ++i) {
    try {
      test::add_vertex(store, map, vocabulary, std::to_string(i), appearances);
      ++acknowledged;
    } catch (const StoreError& error) {
      EXPECT_EQ(error.kind(), StoreErrorKind::kNoSpace) << error.what();
      ++refused;
    }
    EXPECT_EQ(find_map(store.read(), map)->vertices, acknowledged);
  }
  EXPECT_GT(acknowledged, 5U);
  EXPECT_GT(refused, 5);
  EXPECT_TRUE(check_store(store.read()).findings.empty());
  {
    WriteTransaction db = store.write();  // deleting makes room
    EXPECT_EQ(delete_map(db, old), DeleteOutcome::kDeleted);
    db.commit();
  }
  EXPECT_EQ(test::add_vertex(store, map, vocabulary, "again", appearances), VertexId{acknowledged});
  store.reopen();
  EXPECT_EQ(find_map(store.read(), map)->vertices, acknowledged + 1);
  EXPECT_TRUE(check_store(store.read()).findings.empty());
}

}  // namespace
}  // namespace mapweld
