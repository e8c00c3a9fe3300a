// A folder that is served and inspected without a change, and one that may not be written at all.
#include <fstream>
#include <iterator>
#include <map>
#include <optional>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include "schema/engine/data_folder.h"
#include "schema/key_store.h"
#include "tests/support/temp_store.h"

namespace mapweld {
namespace {

namespace fs = std::filesystem;
using test::TempFolder;

constexpr DataFolderOptions kReadOnly{DataFolderOptions::Access::kServeReadOnly, {}};
constexpr DataFolderOptions kInspect{DataFolderOptions::Access::kInspect, {}};

// Names, contents and times of all files in a folder.
std::map<std::string, std::string> contents(const fs::path& folder) {
  std::map<std::string, std::string> files;
  for (const auto& entry : fs::directory_iterator(folder)) {
    std::ifstream in(entry.path(), std::ios::binary);
    files[entry.path().filename()] = std::string(std::istreambuf_iterator<char>(in), {}) +
                                     std::to_string(entry.last_write_time().time_since_epoch().count());
  }
  return files;
}

std::optional<StoreErrorKind> refusal(const fs::path& folder, const DataFolderOptions& options) {
  try {
    const DataFolder data(folder, options);
    return std::nullopt;
  } catch (const StoreError& error) {
    return error.kind();
  }
}

bool has_words(DataFolder& data) { return find_vocabulary(data.store().read(), "words").has_value(); }

// A folder with a database that has the vocabulary "words".
void fill(const fs::path& folder) {
  DataFolder data(folder);
  test::add_vocabulary(data.store());
}

void add_key(const fs::path& folder) {
  KeyRow key;
  key.name = "robot";
  key.role = "read";
  key.maps = "*";
  ASSERT_TRUE(KeyStore(folder).add(key));
}

// A folder whose change is in the WAL only: what a copy of a running server's folder has.
void fill_wal(const TempFolder& temp, const fs::path& folder) {
  DataFolder data(temp.path() / "running");
  test::add_vocabulary(data.store());
  fs::create_directory(folder);
  for (const char* name : {"mapweld.db", "mapweld.db-wal"}) fs::copy(temp.path() / "running" / name, folder / name);
  ASSERT_GT(fs::file_size(folder / "mapweld.db-wal"), 0u);
}

// While it lives, a folder and its files may be read and not written, by this process either.
class Unwritable {
 public:
  explicit Unwritable(const fs::path& folder) : folder_(folder) {
    for (const auto& entry : fs::directory_iterator(folder)) hand_over(entry.path(), 0444);
    hand_over(folder, 0555);
    if (::geteuid() == 0 && ::seteuid(kNobody) != 0) ADD_FAILURE() << "seteuid";
  }
  ~Unwritable() {
    if (::getuid() == 0 && ::seteuid(0) != 0) ADD_FAILURE() << "seteuid";
    ::chmod(folder_.c_str(), 0755);
  }

 private:
  static constexpr uid_t kNobody = 65534;
  static void hand_over(const fs::path& path, mode_t mode) {
    if (::geteuid() == 0) {
      ASSERT_EQ(::chown(path.c_str(), kNobody, kNobody), 0);
    }
    ASSERT_EQ(::chmod(path.c_str(), mode), 0);
  }
  const fs::path folder_;
};

struct ReadOnlyFolder : ::testing::Test {
  ReadOnlyFolder() { ::chmod(temp.path().c_str(), 0755); }
  TempFolder temp;
  const fs::path folder = temp.path() / "data % #1?";  // what means something in a URI
};

TEST_F(ReadOnlyFolder, SeveralServeItAndNothingInItChanges) {
  fill(folder);
  add_key(folder);
  const auto before = contents(folder);
  {
    DataFolder first(folder, kReadOnly);
    DataFolder second(folder, kReadOnly);
    EXPECT_TRUE(has_words(first));
    EXPECT_TRUE(has_words(second));
    EXPECT_TRUE(first.store().is_read_only());
    EXPECT_THROW(first.store().write(), StoreError);
    EXPECT_EQ(KeyStore::open_read_only(folder, 0).list().size(), 1u);
    EXPECT_EQ(contents(folder), before);
  }
  EXPECT_EQ(contents(folder), before);
}

TEST_F(ReadOnlyFolder, IsNotServedBothWaysAtOnce) {
  fill(folder);
  {
    const DataFolder reading(folder, kReadOnly);
    EXPECT_EQ(refusal(folder, {}), StoreErrorKind::kFolderInUse);
  }
  const DataFolder writing(folder);
  EXPECT_EQ(refusal(folder, kReadOnly), StoreErrorKind::kFolderInUse);
}

TEST_F(ReadOnlyFolder, HasToHaveADatabase) {
  EXPECT_EQ(refusal(folder, kReadOnly), StoreErrorKind::kNotFound);
  EXPECT_FALSE(fs::exists(folder));
  fs::create_directory(folder);
  EXPECT_EQ(refusal(folder, kReadOnly), StoreErrorKind::kNotFound);
  EXPECT_TRUE(fs::is_empty(folder));
  EXPECT_TRUE(KeyStore::open_read_only(folder, 0).list().empty());
  EXPECT_TRUE(fs::is_empty(folder));
}

TEST_F(ReadOnlyFolder, WhatIsInTheWalCounts) {
  fill_wal(temp, folder);
  DataFolder data(folder, kReadOnly);
  EXPECT_TRUE(has_words(data));
}

TEST_F(ReadOnlyFolder, MayBeUnwritable) {
  fill(folder);
  add_key(folder);
  const auto before = contents(folder);
  {
    const Unwritable unwritable(folder);
    ASSERT_FALSE(may_write_in(folder));
    DataFolder first(folder, kReadOnly);
    EXPECT_TRUE(has_words(first));
    EXPECT_EQ(KeyStore::open_read_only(folder, 0).list().size(), 1u);
    DataFolder inspected(folder, kInspect);
    EXPECT_TRUE(has_words(inspected));
    check_keys(folder, [](const Finding& finding) { ADD_FAILURE() << finding.what; });
    EXPECT_EQ(refusal(folder, {}), StoreErrorKind::kNoPermission);
  }
  EXPECT_EQ(contents(folder), before);
}

TEST_F(ReadOnlyFolder, UnwritableWithAWalIsRefusedRatherThanReadWithoutIt) {
  fill_wal(temp, folder);
  const Unwritable unwritable(folder);
  EXPECT_EQ(refusal(folder, kReadOnly), StoreErrorKind::kNoPermission);
  EXPECT_EQ(refusal(folder, kInspect), StoreErrorKind::kNoPermission);
}

}  // namespace
}  // namespace mapweld
