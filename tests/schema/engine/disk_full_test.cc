// A file system that is really full: a tmpfs of a few megabytes, mounted in a namespace of a child process.
#include <fstream>
#include <string>

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sched.h>
#include <sys/mount.h>
#include <sys/wait.h>
#include <unistd.h>

#include "schema/store_check.h"
#include "tests/support/temp_store.h"

namespace mapweld {
namespace {

namespace fs = std::filesystem;

void write_file(const char* file, const std::string& text) {
  const int descriptor = ::open(file, O_WRONLY | O_CLOEXEC);
  if (descriptor < 0) return;
  if (::write(descriptor, text.data(), text.size()) < 0) ::perror(file);
  ::close(descriptor);
}

// Mounts `megabytes` of memory at `folder`, for this process alone; without privileges where user namespaces are
// allowed.
bool mount_small(const fs::path& folder, int megabytes) {
  const auto user = std::to_string(::getuid());
  const auto group = std::to_string(::getgid());
  if (::unshare(CLONE_NEWUSER | CLONE_NEWNS) == 0) {
    write_file("/proc/self/setgroups", "deny");
    write_file("/proc/self/uid_map", "0 " + user + " 1");
    write_file("/proc/self/gid_map", "0 " + group + " 1");
  } else if (::unshare(CLONE_NEWNS) != 0) {
    return false;
  }
  if (::mount("none", "/", nullptr, MS_REC | MS_PRIVATE, nullptr) != 0) return false;
  const std::string options = "size=" + std::to_string(megabytes) + "m";
  return ::mount("tmpfs", folder.c_str(), "tmpfs", 0, options.c_str()) == 0;
}

std::string delete_while_full(Store& store, MapId map) {
  try {
    WriteTransaction db = store.write();
    if (delete_map(db, map) != DeleteOutcome::kDeleted) return "it cannot be deleted";
    db.commit();
    return "there is room to delete without the reserve: the test shows nothing";
  } catch (const StoreError& error) {
    if (error.kind() != StoreErrorKind::kNoSpace) return error.what();
  }
  WriteTransaction db = store.write(Store::Purpose::kDelete);
  if (delete_map(db, map) != DeleteOutcome::kDeleted) return "it cannot be deleted";
  db.commit();
  return {};
}

// What went wrong; empty when all is well.
std::string fill_and_go_on(const fs::path& folder) {
  const fs::path ballast = folder / "ballast";
  std::ofstream(ballast) << std::string(1 << 20, 'x');
  std::uint32_t acknowledged = 0;
  MapId map{};
  VocabularyId vocabulary{};
  test::Random random(1);
  const AppearanceVector appearances = test::random_appearances(random, 400, 1'000);
  const auto add = [&](Store& store) {
    test::add_vertex(store, map, vocabulary, std::to_string(acknowledged), appearances);
    ++acknowledged;
  };
  const auto whole = [&](Store& store, const char* when) -> std::string {
    const ReadTransaction reader = store.read();
    if (find_map(reader, map)->vertices != acknowledged) return std::string(when) + ": vertices are missing or added";
    const auto report = check_store(reader);
    if (!report.findings.empty()) return std::string(when) + ": " + report.findings[0].what;
    return {};
  };
  {
    DataFolder data(folder / "data", {.store = {.reserve_bytes = 512 << 10}});
    if (!fs::exists(folder / "data" / "mapweld.reserve")) return "nothing is kept for deleting";
    vocabulary = test::add_vocabulary(data.store());
    map = test::add_map(data.store(), "a", vocabulary);
    const MapId doomed = test::add_map(data.store(), "doomed", vocabulary);
    for (int i = 0; i < 40; ++i) {
      test::add_vertex(data.store(), doomed, vocabulary, std::to_string(i), appearances);
    }
    int refused = 0;
    while (refused < 10) {
      try {
        add(data.store());
        if (acknowledged > 10'000) return "the file system does not fill";
      } catch (const StoreError& error) {
        if (error.kind() != StoreErrorKind::kNoSpace) return std::string("not told as no_space: ") + error.what();
        ++refused;
      }
    }
    if (acknowledged < 50) return "full after " + std::to_string(acknowledged);
    if (auto wrong = whole(data.store(), "while full"); !wrong.empty()) return wrong;
    if (auto wrong = delete_while_full(data.store(), doomed); !wrong.empty()) return wrong;
    fs::remove(ballast);
    add(data.store());
    if (auto wrong = whole(data.store(), "with space again"); !wrong.empty()) return wrong;
  }
  DataFolder data(folder / "data");
  return whole(data.store(), "after a restart");
}

TEST(DiskFull, NothingStoredChangesAndTheStoreGoesOnWhenThereIsSpaceAgain) {
  const test::TempFolder folder;
  int told[2];
  ASSERT_EQ(::pipe(told), 0);
  constexpr int kNotAllowed = 77;
  const pid_t child = ::fork();
  ASSERT_GE(child, 0);
  if (child == 0) {
    if (!mount_small(folder.path(), 8)) ::_exit(kNotAllowed);
    std::string wrong;
    try {
      wrong = fill_and_go_on(folder.path());
    } catch (const std::exception& error) {
      wrong = error.what();
    }
    if (::write(told[1], wrong.data(), wrong.size()) < 0) ::_exit(2);
    ::_exit(wrong.empty() ? 0 : 1);
  }
  ::close(told[1]);
  std::string wrong;
  char buffer[512];
  for (ssize_t n = 0; (n = ::read(told[0], buffer, sizeof buffer)) > 0;)
    wrong.append(buffer, static_cast<std::size_t>(n));
  ::close(told[0]);
  int status = 0;
  ::waitpid(child, &status, 0);
  if (WIFEXITED(status) && WEXITSTATUS(status) == kNotAllowed) {
    GTEST_SKIP() << "mounting a tmpfs is not allowed here; Store.WithoutSpace... plays a full disk by a limit on pages";
  }
  EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0) << wrong;
}

}  // namespace
}  // namespace mapweld
