// Backups over HTTP: made beside uploads, downloaded in parts, restored and compared.
#include <chrono>
#include <filesystem>
#include <fstream>
#include <string>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "schema/engine/data_folder.h"
#include "schema/store_check.h"
#include "tests/server/support/api_under_test.h"
#include "tests/server/support/test_photos.h"

namespace mapweld::test {
namespace {

namespace fs = std::filesystem;

class BackupsTest : public ::testing::Test {
 protected:
  void fill() {
    api_.post("/v1/maps", R"({"name":"a"})");
    for (int step = 0; step < 4; ++step) {
      api_.post_image("/v1/maps/a/images?name=" + std::to_string(step), photo_jpeg(1, step));
    }
  }
  contract::Json finished(const std::string& path) const {
    contract::Json backup;
    for (int i = 0; i < 2000; ++i) {
      backup = api_.get(path).json();
      if (backup["state"] != "running") break;
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    return backup;
  }

  ApiUnderTest api_;
};

TEST_F(BackupsTest, WhatWasThereIsInTheFileThatIsDownloadedInParts) {
  fill();
  const std::string stored = dump_store(api_.services().store());
  const Answer begun = api_.post("/v1/backups", "");
  ASSERT_EQ(begun.status, 202);
  const std::string path = begun.header("Location");
  const contract::Json backup = finished(path);
  EXPECT_EQ(backup["state"], "completed");
  EXPECT_EQ(backup["progress"], 1.0);
  api_.post_image("/v1/maps/a/images?name=later", photo_jpeg(1, 5));

  const auto bytes = backup["bytes"].get<std::size_t>();
  std::string file;
  while (file.size() < bytes) {
    const std::string range = std::to_string(file.size()) + "-" + std::to_string(file.size() + 99'999);
    const Answer part = api_.ask("GET", path + "/content", {{"Range", "bytes=" + range}});
    ASSERT_EQ(part.status, 206);
    file += part.body;
  }
  EXPECT_EQ(file.size(), bytes);
  EXPECT_TRUE(api_.get(path + "/content").body == file);
  const TempFolder out;
  std::ofstream(out.path() / "copy", std::ios::binary) << file;
  restore_backup(out.path() / "copy", out.path() / "data");
  DataFolder again(out.path() / "data");
  EXPECT_TRUE(check_store(again.store().read()).findings.empty());
  EXPECT_EQ(dump_store(again.store()), stored);
}

TEST_F(BackupsTest, TheyAreListedAndDeletedAndOutliveTheServer) {
  fill();
  for (int i = 0; i < 3; ++i) finished(api_.post("/v1/backups", "").header("Location"));
  const contract::Json page = api_.get("/v1/backups?limit=2").json();
  ASSERT_EQ(page["items"].size(), 2u);
  EXPECT_LT(page["items"][0]["id"], page["items"][1]["id"]);
  const std::string cursor = page["next_cursor"];
  EXPECT_EQ(api_.get("/v1/backups?cursor=" + cursor).json()["items"].size(), 1u);
  const std::string first = "/v1/backups/" + std::to_string(page["items"][0]["id"].get<std::int64_t>());
  EXPECT_EQ(api_.del(first).status, 204);
  EXPECT_EQ(api_.get(first).code(), "no_such_backup");
  EXPECT_EQ(api_.get(first + "/content").code(), "no_such_backup");
  EXPECT_EQ(api_.del(first).code(), "no_such_backup");

  const fs::path folder = api_.services().store().file().parent_path() / "backups";
  std::ofstream(folder / "17.db.part") << "unfinished";
  server::BackupService later(api_.services().store(), folder);
  EXPECT_EQ(later.list(10, {}).items.size(), 2u);
  EXPECT_FALSE(fs::exists(folder / "17.db.part"));
  EXPECT_EQ(fs::status(folder).permissions(), fs::perms::owner_all);
}

TEST_F(BackupsTest, OneIsMadeAtATimeAndAFailureIsSaid) {
  fill();
  const fs::path folder = api_.services().store().file().parent_path() / "backups";
  fs::create_directory(folder);
  const auto now = std::chrono::system_clock::now().time_since_epoch();
  const auto second = std::chrono::duration_cast<std::chrono::seconds>(now).count();
  // A folder where the file should come.
  for (int i = 0; i < 30; ++i) fs::create_directory(folder / (std::to_string(second + i) + ".db.part"));
  for (int i = 0; i < 30; ++i) std::ofstream(folder / (std::to_string(second + i) + ".db.part") / "x") << "x";
  const std::string path = api_.post("/v1/backups", "").header("Location");
  const contract::Json backup = finished(path);
  EXPECT_EQ(backup["state"], "failed");
  EXPECT_TRUE(backup["error"].is_string());
  EXPECT_EQ(api_.get(path + "/content").code(), "wrong_state");
}

}  // namespace
}  // namespace mapweld::test
