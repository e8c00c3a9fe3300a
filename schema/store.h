// The store: one SQLite database in WAL mode, one writer, any number of readers.
//
// - Writing: `Store::write()` hands out the one writing transaction; it waits until the former is finished. A commit is
//   durable (synchronous = FULL) when `commit()` returns.
// - Reading: `Store::read()` hands out a transaction on a read-only connection of its own, which sees the state that
// was
//   committed when it began, however long it lives; it never waits for the writer, nor the writer for it.
// - The writer also moves the WAL into the database (checkpoint), after commits: SQLite 3.40 can lose data when two
//   connections write and checkpoint at once, so no other connection ever does.
//
// Functions on tables (map_store.h, vertex_store.h, ...) take a `Reader` to read, which either transaction is, and a
// `WriteTransaction` to write.
#pragma once

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "schema/engine/database.h"
#include "schema/engine/space_reserve.h"

namespace mapweld {

struct StoreOptions {
  bool read_only = false;                   // write() throws kNoPermission
  bool immutable = false;                   // read_only, and nobody else writes either (OpenMode::kImmutable)
  std::uint32_t checkpoint_pages = 1'000;   // move the WAL into the database when it has so many pages (4 KiB each)
  std::uint32_t restart_pages = 16'000;     // and wait for readers, at most 250 ms, to start it over at so many
  int busy_timeout_ms = 5'000;              // how long to wait for a lock that another process holds
  std::uint64_t writer_cache_kib = 16'384;  // page cache of the writer
  std::uint64_t reader_cache_kib = 4'096;   // page cache of each reader
  std::uint64_t reserve_bytes = 0;          // kept free on the disk for deleting (space_reserve.h); 0: none
  std::uint32_t idle_readers = 16;          // read-only connections kept open when nobody reads
};

struct StoreStatistics {
  std::uint64_t commits = 0;
  std::uint64_t wal_checkpoints = 0;
  std::uint64_t failed_wal_checkpoints = 0;  // nothing is lost by one; the WAL grows until one succeeds
  std::string last_wal_checkpoint_error;
  std::uint32_t wal_pages = 0;     // pages in the WAL after the last commit
  std::uint32_t open_readers = 0;  // read-only connections, idle or not
};

class Store;

// Something to read one consistent state of the database from. Belongs to one thread at a time.
class Reader {
 public:
  Reader(const Reader&) = delete;
  Reader& operator=(const Reader&) = delete;
  sqlite::Statement prepare(std::string_view sql) const { return connection_->prepare(sql); }
  sqlite::Connection& connection() const { return *connection_; }

 protected:
  explicit Reader(sqlite::Connection* connection) : connection_(connection) {}
  ~Reader() = default;
  Reader(Reader&&) = default;
  sqlite::Connection* connection_;
};

// A snapshot; ends with its life. Keep it short: the WAL cannot start over while an old snapshot is read.
class ReadTransaction final : public Reader {
 public:
  ReadTransaction(ReadTransaction&& other) noexcept;
  ~ReadTransaction();

 private:
  friend class Store;
  ReadTransaction(Store& store, std::unique_ptr<sqlite::Connection> connection);
  Store* store_;
  std::unique_ptr<sqlite::Connection> owned_;
  std::unique_ptr<sqlite::Transaction> transaction_;
};

// The one writing transaction. Reads what it wrote itself. Rolled back unless committed. A thread that holds one must
// not ask for another: it would wait for itself.
class WriteTransaction final : public Reader {
 public:
  WriteTransaction(WriteTransaction&& other) noexcept;
  ~WriteTransaction();
  // Makes everything written durable and lets the next writer in. Throws kNoSpace, kIo, ...: then nothing is written;
  // kGone: the database is no longer where it was, and nothing is claimed.
  void commit();
  // Forgets everything written and lets the next writer in. Nothing happens when it is finished already.
  void rollback() noexcept;

 private:
  friend class Store;
  WriteTransaction(Store& store, bool may_use_reserve);
  Store* store_;
  std::unique_lock<std::mutex> turn_;
  std::unique_ptr<sqlite::Transaction> transaction_;
};

class Store {
 public:
  // Opens a database file that exists and has the schema of this program (DataFolder sees to both).
  explicit Store(const std::filesystem::path& file, const StoreOptions& options = {});
  // All transactions must have ended. Moves the WAL into the database and closes it.
  ~Store();
  Store(const Store&) = delete;
  Store& operator=(const Store&) = delete;

  enum class Purpose : std::uint8_t {
    kStore,
    kDelete,  // may use the reserve when the disk is full
  };
  // Thread-safe. Throws kBusy when another process writes.
  WriteTransaction write(Purpose purpose = Purpose::kStore);
  // Thread-safe; opens another connection when all are in use.
  ReadTransaction read();

  // Whether the database and its WAL are still the files that were opened: a folder may be removed, replaced or
  // unmounted under a running server, and what is written then is in no file that anybody will find. Thread-safe.
  bool in_place() const;

  // Thread-safe.
  StoreStatistics statistics() const;

  // Told the share that is done, now and then; false gives up.
  using GoesOn = std::function<bool(double share)>;
  // A consistent copy of the database, taken while others read and write; `target` must not exist, and appears when it
  // is whole and safe on the disk. False: given up, and nothing is left. Thread-safe.
  bool backup(const std::filesystem::path& target, const GoesOn& goes_on = {});

  bool is_read_only() const { return options_.read_only; }

  // The most pages the database may have (PRAGMA max_page_count): a quota, which answers kNoSpace beyond.
  void limit_pages(std::uint32_t pages);

  const std::filesystem::path& file() const { return file_; }

 private:
  friend class ReadTransaction;
  friend class WriteTransaction;
  std::unique_ptr<sqlite::Connection> open_reader();
  void give_back(std::unique_ptr<sqlite::Connection> reader) noexcept;
  void after_commit() noexcept;
  bool move_wal(int how) noexcept;  // one of SQLITE_CHECKPOINT_*; true when all of it was moved

  // A file by what it is, whatever its name.
  struct Identity {
    std::uint64_t device = 0;
    std::uint64_t inode = 0;
    bool operator==(const Identity&) const = default;
  };
  static std::optional<Identity> identity_of(const std::filesystem::path& file);
  void refuse_when_gone() const;

  std::filesystem::path file_;
  std::filesystem::path wal_;
  StoreOptions options_;
  std::optional<Identity> opened_;
  std::atomic<bool> wal_known_ = false;  // once true, opened_wal_ stays as it is
  Identity opened_wal_;
  std::mutex writer_turn_;
  SpaceReserve reserve_;  // this and the next: guarded by writer_turn_
  std::uint64_t commits_ = 0;
  std::unique_ptr<sqlite::Connection> writer_;
  std::uint32_t wal_pages_ = 0;         // told by SQLite after each commit; guarded by writer_turn_
  std::uint32_t wal_pages_before_ = 0;  // this and what follows: guarded by writer_turn_
  std::uint32_t next_checkpoint_pages_ = 0;
  std::uint32_t next_restart_pages_ = 0;
  mutable std::mutex mutex_;  // guards what follows
  std::vector<std::unique_ptr<sqlite::Connection>> idle_readers_;
  StoreStatistics statistics_;
};

}  // namespace mapweld
