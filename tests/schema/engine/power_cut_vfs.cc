#include "tests/schema/engine/power_cut_vfs.h"

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <sqlite3.h>

namespace mapweld::test {
namespace {

using Bytes = std::vector<char>;
constexpr std::size_t kSector = 512;

// A write, or where there are no bytes the cutting of the file to `at`.
struct Change {
  std::size_t at = 0;
  std::optional<Bytes> bytes;
};

struct DiskFile {
  std::optional<Bytes> synced;  // none: no such file, as far as the disk knows
  std::vector<Change> changes;  // since
  bool exists = false;          // as programs see it
};

struct Disk {
  sqlite3_vfs* real = nullptr;
  PowerCutVfs::Below below;
  std::map<std::string, DiskFile> files;
  std::uint64_t calls_left = 0;  // 0: no cut is planned
  bool off = false;
  bool fail_sync = false;

  // False: the power is off.
  bool change() {
    if (!off && calls_left > 0 && --calls_left == 0) off = true;
    return !off;
  }
};

Disk* disk = nullptr;
sqlite3_vfs vfs;

// As SQLite has it: what follows it in memory is the file of the real VFS.
struct File {
  sqlite3_file base;
  DiskFile* on_disk;  // null: a temporary file
  sqlite3_file* real() { return reinterpret_cast<sqlite3_file*>(this + 1); }
};

File& of(sqlite3_file* file) { return *reinterpret_cast<File*>(file); }

Bytes content_of(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

int close_file(sqlite3_file* file) { return of(file).real()->pMethods->xClose(of(file).real()); }

int read_file(sqlite3_file* file, void* into, int count, sqlite3_int64 at) {
  if (disk->off) return SQLITE_IOERR_READ;
  return of(file).real()->pMethods->xRead(of(file).real(), into, count, at);
}

int write_file(sqlite3_file* file, const void* from, int count, sqlite3_int64 at) {
  const bool on = disk->change();
  if (DiskFile* on_disk = of(file).on_disk) {  // the write during which the power goes may be half on the disk
    const auto* bytes = static_cast<const char*>(from);
    on_disk->changes.push_back({static_cast<std::size_t>(at), Bytes(bytes, bytes + count)});
  }
  return on ? of(file).real()->pMethods->xWrite(of(file).real(), from, count, at) : SQLITE_IOERR_WRITE;
}

int truncate_file(sqlite3_file* file, sqlite3_int64 size) {
  if (!disk->change()) return SQLITE_IOERR_TRUNCATE;
  if (DiskFile* on_disk = of(file).on_disk) on_disk->changes.push_back({static_cast<std::size_t>(size), std::nullopt});
  return of(file).real()->pMethods->xTruncate(of(file).real(), size);
}

void apply(Bytes& content, const Change& change) {
  if (!change.bytes) {
    content.resize(change.at);
    return;
  }
  content.resize(std::max(content.size(), change.at + change.bytes->size()));
  std::ranges::copy(*change.bytes, content.begin() + static_cast<std::ptrdiff_t>(change.at));
}

int sync_file(sqlite3_file* file, int) {
  if (!disk->change() || std::exchange(disk->fail_sync, false)) return SQLITE_IOERR_FSYNC;
  if (DiskFile* on_disk = of(file).on_disk) {
    if (!on_disk->synced) on_disk->synced.emplace();
    for (const Change& change : on_disk->changes) apply(*on_disk->synced, change);
    on_disk->changes.clear();
  }
  return SQLITE_OK;
}

int size_of_file(sqlite3_file* file, sqlite3_int64* size) {
  return of(file).real()->pMethods->xFileSize(of(file).real(), size);
}
int lock_file(sqlite3_file* file, int lock) { return of(file).real()->pMethods->xLock(of(file).real(), lock); }
int unlock_file(sqlite3_file* file, int lock) { return of(file).real()->pMethods->xUnlock(of(file).real(), lock); }
int is_reserved(sqlite3_file* file, int* result) {
  return of(file).real()->pMethods->xCheckReservedLock(of(file).real(), result);
}
int control_file(sqlite3_file* file, int what, void* argument) {
  return of(file).real()->pMethods->xFileControl(of(file).real(), what, argument);
}
int sector_size(sqlite3_file* file) { return of(file).real()->pMethods->xSectorSize(of(file).real()); }
int characteristics(sqlite3_file* file) { return of(file).real()->pMethods->xDeviceCharacteristics(of(file).real()); }
int map_shared(sqlite3_file* file, int page, int size, int extend, void volatile** memory) {
  return of(file).real()->pMethods->xShmMap(of(file).real(), page, size, extend, memory);
}
int lock_shared(sqlite3_file* file, int offset, int n, int flags) {
  return of(file).real()->pMethods->xShmLock(of(file).real(), offset, n, flags);
}
void barrier(sqlite3_file* file) { of(file).real()->pMethods->xShmBarrier(of(file).real()); }
int unmap_shared(sqlite3_file* file, int remove) {
  return of(file).real()->pMethods->xShmUnmap(of(file).real(), remove);
}

constexpr sqlite3_io_methods kMethods = {.iVersion = 2,
                                         .xClose = close_file,
                                         .xRead = read_file,
                                         .xWrite = write_file,
                                         .xTruncate = truncate_file,
                                         .xSync = sync_file,
                                         .xFileSize = size_of_file,
                                         .xLock = lock_file,
                                         .xUnlock = unlock_file,
                                         .xCheckReservedLock = is_reserved,
                                         .xFileControl = control_file,
                                         .xSectorSize = sector_size,
                                         .xDeviceCharacteristics = characteristics,
                                         .xShmMap = map_shared,
                                         .xShmLock = lock_shared,
                                         .xShmBarrier = barrier,
                                         .xShmUnmap = unmap_shared,
                                         .xFetch = nullptr,
                                         .xUnfetch = nullptr};

int open_file(sqlite3_vfs*, const char* name, sqlite3_file* file, int flags, int* flags_out) {
  File& opened = of(file);
  opened.base.pMethods = nullptr;
  opened.on_disk = nullptr;
  const bool existed = name != nullptr && std::filesystem::exists(name);
  if (name != nullptr && !existed && !disk->change()) return SQLITE_CANTOPEN;
  const int result = disk->real->xOpen(disk->real, name, opened.real(), flags, flags_out);
  if (opened.real()->pMethods != nullptr) opened.base.pMethods = &kMethods;
  if (result != SQLITE_OK || name == nullptr) return result;
  const auto [entry, is_new] = disk->files.try_emplace(name);
  opened.on_disk = &entry->second;
  if (is_new && existed) opened.on_disk->synced = content_of(name);
  opened.on_disk->exists = true;
  return SQLITE_OK;
}

int delete_file(sqlite3_vfs*, const char* name, int sync_folder) {
  if (!disk->change()) return SQLITE_IOERR_DELETE;
  const int result = disk->real->xDelete(disk->real, name, sync_folder);
  if (const auto found = disk->files.find(name); result == SQLITE_OK && found != disk->files.end()) {
    found->second.exists = false;
    if (sync_folder != 0) found->second = {};
  }
  return result;
}

// What the disk holds after the cut.
std::optional<Bytes> left_of(const DiskFile& file) {
  const auto& below = disk->below;
  if (!file.synced && below(2) == 0) return std::nullopt;
  if (!file.exists && below(2) == 0) return std::nullopt;
  Bytes content = file.synced.value_or(Bytes());
  const std::uint64_t of_ten = below(3) == 0 ? 10 : below(10);  // so many of ten sectors made it
  const bool tears = below(3) == 0;
  for (const Change& change : file.changes) {
    if (!change.bytes) {
      if (below(10) < of_ten) apply(content, change);
      continue;
    }
    std::size_t begin = 0;
    while (begin < change.bytes->size()) {
      const std::size_t end = std::min(change.bytes->size(), ((change.at + begin) / kSector + 1) * kSector - change.at);
      const bool torn = tears && below(10) == 0;
      const std::size_t reached = torn ? begin + below(end - begin + 1) : end;
      if (below(10) < of_ten && reached > begin) {
        const auto* bytes = change.bytes->data();
        apply(content, {change.at + begin, Bytes(bytes + begin, bytes + reached)});
      }
      begin = end;
    }
  }
  return content;
}

}  // namespace

PowerCutVfs::PowerCutVfs(Below below) {
  if (disk != nullptr) throw std::logic_error("there is a PowerCutVfs already");
  disk = new Disk{.real = sqlite3_vfs_find(nullptr), .below = std::move(below), .files = {}};
  vfs = *disk->real;
  vfs.pNext = nullptr;
  vfs.zName = "power-cut";
  vfs.szOsFile = static_cast<int>(sizeof(File)) + disk->real->szOsFile;
  vfs.xOpen = open_file;
  vfs.xDelete = delete_file;
  sqlite3_vfs_register(&vfs, 1);
}

PowerCutVfs::~PowerCutVfs() {
  sqlite3_vfs_unregister(&vfs);
  sqlite3_vfs_register(disk->real, 1);
  delete std::exchange(disk, nullptr);
}

void PowerCutVfs::cut_at(std::uint64_t n) { disk->calls_left = n; }

void PowerCutVfs::fail_next_sync() { disk->fail_sync = true; }

bool PowerCutVfs::is_off() const { return disk->off; }

void PowerCutVfs::restore() {
  for (const auto& [path, file] : disk->files) {
    const std::optional<Bytes> left = left_of(file);
    std::filesystem::remove(path);
    std::filesystem::remove(path + "-shm");
    if (!left) continue;
    std::ofstream out(path, std::ios::binary);
    out.write(left->data(), static_cast<std::streamsize>(left->size()));
    if (!out.flush()) throw std::runtime_error("cannot write " + path);
  }
  disk->files.clear();
  disk->calls_left = 0;
  disk->off = false;
}

}  // namespace mapweld::test
