// RAII over sqlite3: a connection, its statements, a transaction. Nothing here knows a table.
//
// A connection and everything made from it belong to one thread at a time (SQLite runs without its own mutex). A
// statement or transaction must not outlive its connection. Every function throws StoreError when SQLite fails.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "schema/engine/store_error.h"

struct sqlite3;
struct sqlite3_stmt;

namespace mapweld::sqlite {

class Connection;

// A prepared statement on loan from its connection's cache: the destructor resets it, forgets its bindings and gives it
// back. Parameters count from 1, columns from 0, as in SQLite.
class Statement {
 public:
  Statement(Statement&& other) noexcept;
  Statement& operator=(Statement&&) = delete;
  ~Statement();

  // Text is copied. A blob is not: keep it alive and unchanged until the statement has run.
  Statement& bind(int parameter, std::int64_t value);
  Statement& bind(int parameter, double value);
  Statement& bind(int parameter, std::string_view text);
  Statement& bind(int parameter, std::span<const std::uint8_t> blob);
  Statement& bind_null(int parameter);
  // The value of a column of another statement's current row, of whatever type.
  Statement& bind_column(int parameter, const Statement& row, int column);

  template <typename Integer>
  requires std::is_integral_v<Integer> Statement& bind(int parameter, Integer value) {
    return bind(parameter, static_cast<std::int64_t>(value));
  }
  template <typename Id>
  requires std::is_enum_v<Id> Statement& bind(int parameter, Id id) {
    return bind(parameter, static_cast<std::int64_t>(id));
  }
  Statement& bind(int parameter, const char* text) { return bind(parameter, std::string_view(text)); }
  Statement& bind(int parameter, const std::string& text) { return bind(parameter, std::string_view(text)); }
  template <typename T>
  Statement& bind(int parameter, const std::optional<T>& value) {
    return value ? bind(parameter, *value) : bind_null(parameter);
  }
  // Binds parameters 1 .. n.
  template <typename... Values>
  Statement& bind_all(const Values&... values) {
    int parameter = 0;
    (bind(++parameter, values), ...);
    return *this;
  }

  // Goes to the next row; false when there is none left.
  bool step();
  // Runs to the end, whatever rows come; then resets, so that it can be bound and run again.
  void run();
  // Makes the statement ready to run again; bindings stay.
  void reset();

  // Columns of the current row. Text and blobs stay valid until the next step, reset or the end of the statement.
  bool is_null(int column) const;
  std::int64_t integer(int column) const;
  double real(int column) const;
  std::string_view text(int column) const;
  std::span<const std::uint8_t> blob(int column) const;

  template <typename Id>
  Id id(int column) const {
    return static_cast<Id>(integer(column));
  }
  std::optional<std::int64_t> optional_integer(int column) const;
  std::optional<double> optional_real(int column) const;
  std::optional<std::string> optional_text(int column) const;

 private:
  friend class Connection;
  Statement(Connection& connection, sqlite3_stmt* handle) : connection_(&connection), handle_(handle) {}
  void check(int result) const;

  Connection* connection_;
  sqlite3_stmt* handle_;
};

// How a connection opens its file.
enum class OpenMode : std::uint8_t {
  kReadWrite,  // the file must exist
  kCreate,     // created when missing, for its owner only (0600), as the files that SQLite lays beside it are
  kReadOnly,   // and query_only
  kImmutable,  // the same of a file that nobody changes while it is open, in a folder that may not be written: no
               // locks, no WAL
};

// An open database file. Foreign keys are enforced, `synchronous` is FULL and nothing checkpoints by itself
// (wal_autocheckpoint = 0): the store does that, on its one writing connection.
class Connection {
 public:
  // Throws StoreError: kNoPermission, kForeignDatabase (no SQLite file), kIo, kBusy.
  Connection(const std::filesystem::path& file, OpenMode mode);
  ~Connection();
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;

  // Prepares `sql`, one statement, or takes it from the cache.
  Statement prepare(std::string_view sql);
  // Runs a script of statements that give no rows.
  void execute(const std::string& script);
  // The first column of the first row of `sql`, as an integer.
  std::int64_t query_integer(std::string_view sql);

  std::int64_t last_insert_rowid() const;
  // Rows changed by the last INSERT, UPDATE or DELETE.
  std::int64_t changes() const;
  bool in_transaction() const;
  // How long a statement waits for a lock that another process holds; 5,000 ms when opened.
  void set_busy_timeout_ms(int timeout_ms);

  sqlite3* handle() { return handle_; }

 private:
  friend class Statement;
  void give_back(sqlite3_stmt* handle) noexcept;

  sqlite3* handle_ = nullptr;
  std::map<std::string, std::vector<sqlite3_stmt*>, std::less<>> cache_;
};

// A transaction that is rolled back unless it was committed. Remembers that it is finished: a second commit throws
// kInternal, a second rollback does nothing.
class Transaction {
 public:
  enum class Kind : std::uint8_t {
    kRead,   // BEGIN DEFERRED and a first read: everything read sees one state of the database
    kWrite,  // BEGIN IMMEDIATE: waits for the write lock at once
  };
  Transaction(Connection& connection, Kind kind);
  ~Transaction();
  Transaction(const Transaction&) = delete;
  Transaction& operator=(const Transaction&) = delete;

  void commit();
  void rollback() noexcept;
  bool finished() const { return finished_; }

 private:
  Connection& connection_;
  bool finished_ = false;
};

// The StoreError of a failed call on `handle` (which may be null: the code alone is told).
StoreError error_of(sqlite3* handle, int result, std::string_view doing);

}  // namespace mapweld::sqlite
