#include "schema/engine/data_folder.h"

#include <fstream>
#include <functional>
#include <iterator>
#include <map>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include "schema/engine/migrations.h"
#include "tests/support/temp_store.h"

namespace mapweld {
namespace {

namespace fs = std::filesystem;
using test::TempFolder;

constexpr DataFolderOptions kInspect{DataFolderOptions::Access::kInspect, {}};

// Names and contents of all files in a folder.
std::map<std::string, std::string> contents(const fs::path& folder) {
  std::map<std::string, std::string> files;
  for (const auto& entry : fs::directory_iterator(folder)) {
    std::ifstream in(entry.path(), std::ios::binary);
    files[entry.path().filename()] = std::string(std::istreambuf_iterator<char>(in), {});
  }
  return files;
}

StoreError refused(const fs::path& folder, const DataFolderOptions& options = {}) {
  try {
    const DataFolder data(folder, options);
  } catch (const StoreError& error) {
    return error;
  }
  ADD_FAILURE() << "the folder was opened";
  return {StoreErrorKind::kInternal, ""};
}

TEST(DataFolder, AFreshOneIsMadeWithItsParentsAndOpensAgain) {
  const TempFolder temp;
  const fs::path folder = temp.path() / "a" / "b";
  {
    DataFolder data(folder);
    EXPECT_EQ(data.version_found(), 0);
    test::add_vocabulary(data.store());
  }
  DataFolder data(folder);
  EXPECT_EQ(data.version_found(), schema_version());
  EXPECT_EQ(list_vocabularies(data.store().read(), 10).size(), 1U);
}

TEST(DataFolder, NothingOfTheWalIsLeftAfterACleanEnd) {
  const TempFolder temp;
  {
    DataFolder data(temp.path());
    test::add_vocabulary(data.store());
    const ReadTransaction reader = data.store().read();
    EXPECT_TRUE(find_vocabulary(reader, "words"));
  }
  EXPECT_FALSE(fs::exists(temp.path() / "mapweld.db-wal"));
}

TEST(DataFolder, ASecondServerIsRefusedAndToldWhoHasIt) {
  const TempFolder temp;
  const DataFolder first(temp.path());
  const StoreError error = refused(temp.path());
  EXPECT_EQ(error.kind(), StoreErrorKind::kFolderInUse);
  EXPECT_THAT(error.what(), testing::HasSubstr(temp.path().string()));
  EXPECT_THAT(error.what(), testing::HasSubstr(std::to_string(::getpid())));
}

TEST(DataFolder, RemovingTheLockLetsNoSecondServerIn) {
  const TempFolder temp;
  const DataFolder first(temp.path());
  fs::remove(temp.path() / "mapweld.lock");
  EXPECT_EQ(refused(temp.path()).kind(), StoreErrorKind::kFolderInUse);
}

// Whoever writes to a database that nobody will find again must not be told that it is stored.
TEST(DataFolder, WhatIsWrittenToADatabaseThatWasTakenAwayIsNotClaimed) {
  const auto refusal = [](Store& store) {
    try {
      WriteTransaction db = store.write();
      db.prepare("PRAGMA user_version").run();
      db.commit();
      return std::string("claimed");
    } catch (const StoreError& error) {
      return std::string(to_string(error.kind()));
    }
  };
  const TempFolder temp;
  const auto open = [&](const char* name) {
    auto data = std::make_unique<DataFolder>(temp.path() / name);
    test::add_vocabulary(data->store());
    EXPECT_TRUE(data->store().in_place());
    EXPECT_EQ(refusal(data->store()), "claimed");
    return data;
  };
  const auto removed = open("removed");
  fs::remove_all(temp.path() / "removed");
  EXPECT_FALSE(removed->store().in_place());
  EXPECT_EQ(refusal(removed->store()), "gone");

  const auto replaced = open("replaced");
  fs::rename(temp.path() / "replaced", temp.path() / "elsewhere");
  { const DataFolder other(temp.path() / "replaced"); }
  EXPECT_FALSE(replaced->store().in_place());
  EXPECT_EQ(refusal(replaced->store()), "gone");
  std::vector<ReadTransaction> readers;  // more than are open already
  const auto read = [&] {
    for (int i = 0; i < 3; ++i) readers.push_back(replaced->store().read());
  };
  EXPECT_THROW(read(), StoreError) << "nobody reads from another database";
  readers.clear();

  const auto without_wal = open("without-wal");
  fs::remove(temp.path() / "without-wal" / "mapweld.db-wal");
  EXPECT_FALSE(without_wal->store().in_place());
  EXPECT_EQ(refusal(without_wal->store()), "gone");
}

TEST(DataFolder, ADeadServerHoldsNoLock) {
  const TempFolder temp;
  int ready[2];
  ASSERT_EQ(::pipe(ready), 0);
  const pid_t child = ::fork();
  ASSERT_GE(child, 0);
  if (child == 0) {
    const DataFolder data(temp.path());
    const char byte = 1;
    if (::write(ready[1], &byte, 1) != 1) ::_exit(1);
    ::pause();
    ::_exit(0);
  }
  char byte = 0;
  ASSERT_EQ(::read(ready[0], &byte, 1), 1);
  EXPECT_EQ(refused(temp.path()).kind(), StoreErrorKind::kFolderInUse);
  ::kill(child, SIGKILL);
  ::waitpid(child, nullptr, 0);
  EXPECT_NO_THROW(DataFolder{temp.path()});
  ::close(ready[0]);
  ::close(ready[1]);
}

TEST(DataFolder, TheDatabaseOfAnotherApplicationIsRefusedUntouched) {
  const TempFolder temp;
  for (const int application_id : {0, 0x47504B47}) {  // SQLite's default, GeoPackage
    for (const char* mode : {"DELETE", "WAL"}) {
      fs::remove(temp.path() / "mapweld.db");
      {
        sqlite::Connection other(temp.path() / "mapweld.db", sqlite::OpenMode::kCreate);
        other.execute("PRAGMA application_id = " + std::to_string(application_id));
        other.execute("PRAGMA journal_mode = " + std::string(mode) + "; CREATE TABLE birds (name TEXT)");
      }
      const auto before = contents(temp.path());
      EXPECT_EQ(refused(temp.path()).kind(), StoreErrorKind::kForeignDatabase);
      EXPECT_EQ(refused(temp.path(), kInspect).kind(), StoreErrorKind::kForeignDatabase);
      EXPECT_EQ(contents(temp.path()), before);
    }
  }
}

TEST(DataFolder, AFileThatIsNoDatabaseIsRefusedUntouched) {
  const TempFolder temp;
  std::ofstream(temp.path() / "mapweld.db") << "my diary";
  const auto before = contents(temp.path());
  EXPECT_EQ(refused(temp.path()).kind(), StoreErrorKind::kForeignDatabase);
  EXPECT_EQ(contents(temp.path()), before);
}

TEST(DataFolder, ANewerDatabaseIsRefusedUntouched) {
  const TempFolder temp;
  { const DataFolder data(temp.path()); }
  {
    sqlite::Connection newer(temp.path() / "mapweld.db", sqlite::OpenMode::kReadWrite);
    newer.execute("PRAGMA user_version = " + std::to_string(schema_version() + 1));
  }
  const auto before = contents(temp.path());
  EXPECT_EQ(refused(temp.path()).kind(), StoreErrorKind::kNewerVersion);
  EXPECT_EQ(refused(temp.path(), kInspect).kind(), StoreErrorKind::kNewerVersion);
  EXPECT_EQ(contents(temp.path()), before);
}

TEST(DataFolder, AnEmptyFileAndAnInterruptedCreationAreBegunAnew) {
  const TempFolder temp;
  std::ofstream(temp.path() / "mapweld.db").flush();
  std::ofstream(temp.path() / "mapweld.db.new") << "half a database";
  std::ofstream(temp.path() / "mapweld.db.new-journal") << "half a journal";
  DataFolder data(temp.path());
  test::add_vocabulary(data.store());
  EXPECT_FALSE(fs::exists(temp.path() / "mapweld.db.new"));
}

TEST(DataFolder, AWalWithoutItsDatabaseIsNotReplayedOntoANewOne) {
  const TempFolder temp;
  std::ofstream(temp.path() / "mapweld.db-wal") << "pages of a database that is elsewhere";
  EXPECT_EQ(refused(temp.path()).kind(), StoreErrorKind::kCorrupt);
  EXPECT_FALSE(fs::exists(temp.path() / "mapweld.db"));
}

TEST(DataFolder, InspectionReadsBesideAServerAndWritesNothing) {
  const TempFolder temp;
  EXPECT_EQ(refused(temp.path(), kInspect).kind(), StoreErrorKind::kNotFound);
  {
    DataFolder server(temp.path());
    test::add_vocabulary(server.store());
    DataFolder inspection(temp.path(), kInspect);
    EXPECT_TRUE(find_vocabulary(inspection.store().read(), "words"));
    EXPECT_THROW(inspection.store().write(), StoreError);
    test::add_vocabulary(server.store(), "more");
    EXPECT_TRUE(find_vocabulary(inspection.store().read(), "more"));
  }
  const auto before = contents(temp.path());
  {
    DataFolder inspection(temp.path(), kInspect);
    EXPECT_TRUE(find_vocabulary(inspection.store().read(), "more"));
    EXPECT_EQ(refused(temp.path()).kind(), StoreErrorKind::kFolderInUse);
  }
  EXPECT_EQ(contents(temp.path()), before);
}

TEST(DataFolder, WhatIsMadeIsItsOwnersOnly) {
  constexpr fs::perms kOwnersFile = fs::perms::owner_read | fs::perms::owner_write;
  const TempFolder temp;
  const fs::path folder = temp.path() / "data";
  {
    DataFolder data(folder);
    test::add_vocabulary(data.store());
    EXPECT_EQ(fs::status(folder).permissions(), fs::perms::owner_all);
    int files = 0;
    for (const fs::directory_entry& file : fs::directory_iterator(folder)) {
      EXPECT_EQ(file.status().permissions(), kOwnersFile) << file.path();
      ++files;
    }
    EXPECT_GE(files, 4);  // mapweld.db, its -wal and -shm, mapweld.lock, perhaps the reserve
  }
  // An earlier version's file, which everybody may read.
  fs::permissions(folder / "mapweld.db", kOwnersFile | fs::perms::group_read | fs::perms::others_read);
  const DataFolder data(folder);
  EXPECT_EQ(fs::status(folder / "mapweld.db").permissions(), kOwnersFile | fs::perms::group_read);
}

TEST(DataFolder, AFolderThatCannotBeMadeIsAClearError) {
  const TempFolder temp;
  std::ofstream(temp.path() / "file") << "x";
  EXPECT_THAT(refused(temp.path() / "file" / "data").what(), testing::HasSubstr("file"));
}

}  // namespace
}  // namespace mapweld
