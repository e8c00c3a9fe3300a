#include "schema/engine/database.h"

#include <cerrno>
#include <cstring>
#include <utility>

#include <fcntl.h>
#include <sqlite3.h>
#include <unistd.h>

#include "schema/engine/checksum_function.h"

namespace mapweld::sqlite {
namespace {

StoreErrorKind kind_of(int extended, int system_errno) {
  switch (extended & 0xff) {
    case SQLITE_FULL:
      return StoreErrorKind::kNoSpace;
    case SQLITE_BUSY:
    case SQLITE_LOCKED:
      return StoreErrorKind::kBusy;
    case SQLITE_CORRUPT:
      return StoreErrorKind::kCorrupt;
    case SQLITE_NOTADB:
      return StoreErrorKind::kForeignDatabase;
    case SQLITE_CANTOPEN:
      if (system_errno == EMFILE || system_errno == ENFILE) return StoreErrorKind::kNoResources;
      return StoreErrorKind::kNoPermission;
    case SQLITE_PERM:
    case SQLITE_READONLY:
    case SQLITE_AUTH:
      return StoreErrorKind::kNoPermission;
    case SQLITE_NOMEM:
      return StoreErrorKind::kNoResources;
    case SQLITE_CONSTRAINT:
    case SQLITE_MISMATCH:
    case SQLITE_TOOBIG:
      return StoreErrorKind::kConstraint;
    case SQLITE_IOERR:
      // The VFS tells a full disk as SQLITE_FULL where it writes pages, but not where it grows the shared memory file.
      if (system_errno == ENOSPC || system_errno == EDQUOT) return StoreErrorKind::kNoSpace;
      if (system_errno == EMFILE || system_errno == ENFILE || extended == SQLITE_IOERR_NOMEM) {
        return StoreErrorKind::kNoResources;
      }
      return StoreErrorKind::kIo;
    default:
      return StoreErrorKind::kInternal;
  }
}

// SQLite would make it readable for everybody. An empty file is a database to it; what exists is left as it is. (Never
// open and close a file that is a database already: that ends the locks of this process on it.)
void create_for_owner(const std::filesystem::path& file) {
  const int descriptor = ::open(file.c_str(), O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, 0600);
  if (descriptor >= 0) ::close(descriptor);
}

// https://www.sqlite.org/uri.html
std::string immutable_uri(const std::filesystem::path& file) {
  std::string uri = "file:";
  for (const char letter : std::filesystem::absolute(file).string()) {
    switch (letter) {
      case '%':
        uri += "%25";
        break;
      case '?':
        uri += "%3f";
        break;
      case '#':
        uri += "%23";
        break;
      default:
        uri += letter;
    }
  }
  return uri + "?immutable=1";
}

}  // namespace

StoreError error_of(sqlite3* handle, int result, std::string_view doing) {
  const int extended = handle != nullptr ? sqlite3_extended_errcode(handle) : result;
  const int code = (extended & 0xff) == (result & 0xff) ? extended : result;
  const int system_errno = handle != nullptr ? sqlite3_system_errno(handle) : 0;
  std::string what(doing);
  what += ": ";
  what += handle != nullptr && code == extended ? sqlite3_errmsg(handle) : sqlite3_errstr(result);
  if ((code & 0xff) == SQLITE_IOERR && system_errno != 0) {
    what += " (";
    what += std::strerror(system_errno);
    what += ")";
  }
  return StoreError(kind_of(code, system_errno), what);
}

Statement::Statement(Statement&& other) noexcept
    : connection_(other.connection_), handle_(std::exchange(other.handle_, nullptr)) {}

Statement::~Statement() {
  if (handle_ != nullptr) connection_->give_back(handle_);
}

void Statement::check(int result) const {
  if (result == SQLITE_OK || result == SQLITE_ROW || result == SQLITE_DONE) return;
  throw error_of(connection_->handle(), result, sqlite3_sql(handle_));
}

Statement& Statement::bind(int parameter, std::int64_t value) {
  check(sqlite3_bind_int64(handle_, parameter, value));
  return *this;
}

Statement& Statement::bind(int parameter, double value) {
  check(sqlite3_bind_double(handle_, parameter, value));
  return *this;
}

Statement& Statement::bind(int parameter, std::string_view text) {
  // A null pointer would bind NULL: an empty view may have one.
  const char* data = text.data() != nullptr ? text.data() : "";
  check(sqlite3_bind_text64(handle_, parameter, data, text.size(), SQLITE_TRANSIENT, SQLITE_UTF8));
  return *this;
}

Statement& Statement::bind(int parameter, std::span<const std::uint8_t> blob) {
  static constexpr std::uint8_t kEmpty = 0;
  const std::uint8_t* data = blob.data() != nullptr ? blob.data() : &kEmpty;
  check(sqlite3_bind_blob64(handle_, parameter, data, blob.size(), SQLITE_STATIC));
  return *this;
}

Statement& Statement::bind_null(int parameter) {
  check(sqlite3_bind_null(handle_, parameter));
  return *this;
}

Statement& Statement::bind_column(int parameter, const Statement& row, int column) {
  check(sqlite3_bind_value(handle_, parameter, sqlite3_column_value(row.handle_, column)));
  return *this;
}

bool Statement::step() {
  const int result = sqlite3_step(handle_);
  if (result == SQLITE_ROW) return true;
  if (result == SQLITE_DONE) return false;
  const StoreError error = error_of(connection_->handle(), result, sqlite3_sql(handle_));
  sqlite3_reset(handle_);
  throw error;
}

void Statement::run() {
  while (step()) {
  }
  sqlite3_reset(handle_);
}

void Statement::reset() { sqlite3_reset(handle_); }

bool Statement::is_null(int column) const { return sqlite3_column_type(handle_, column) == SQLITE_NULL; }

std::int64_t Statement::integer(int column) const { return sqlite3_column_int64(handle_, column); }

double Statement::real(int column) const { return sqlite3_column_double(handle_, column); }

std::string_view Statement::text(int column) const {
  const auto* data = reinterpret_cast<const char*>(sqlite3_column_text(handle_, column));
  if (data == nullptr) return {};
  return {data, static_cast<std::size_t>(sqlite3_column_bytes(handle_, column))};
}

std::span<const std::uint8_t> Statement::blob(int column) const {
  const auto* data = static_cast<const std::uint8_t*>(sqlite3_column_blob(handle_, column));
  if (data == nullptr) return {};
  return {data, static_cast<std::size_t>(sqlite3_column_bytes(handle_, column))};
}

std::optional<std::int64_t> Statement::optional_integer(int column) const {
  if (is_null(column)) return std::nullopt;
  return integer(column);
}

std::optional<double> Statement::optional_real(int column) const {
  if (is_null(column)) return std::nullopt;
  return real(column);
}

std::optional<std::string> Statement::optional_text(int column) const {
  if (is_null(column)) return std::nullopt;
  return std::string(text(column));
}

Connection::Connection(const std::filesystem::path& file, OpenMode mode) {
  int flags = SQLITE_OPEN_NOMUTEX | SQLITE_OPEN_EXRESCODE;
  switch (mode) {
    case OpenMode::kReadWrite:
      flags |= SQLITE_OPEN_READWRITE;
      break;
    case OpenMode::kCreate:
      flags |= SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE;
      break;
    case OpenMode::kReadOnly:
      flags |= SQLITE_OPEN_READONLY;
      break;
    case OpenMode::kImmutable:
      flags |= SQLITE_OPEN_READONLY | SQLITE_OPEN_URI;
      break;
  }
  if (mode == OpenMode::kCreate) create_for_owner(file);
  const std::string name = mode == OpenMode::kImmutable ? immutable_uri(file) : file.string();
  const int result = sqlite3_open_v2(name.c_str(), &handle_, flags, nullptr);
  if (result != SQLITE_OK) {
    const StoreError error = error_of(handle_, result, "cannot open " + file.string());
    sqlite3_close_v2(handle_);
    throw error;
  }
  try {
    set_busy_timeout_ms(5'000);
    sqlite3_db_config(handle_, SQLITE_DBCONFIG_DEFENSIVE, 1, nullptr);
    execute(
        "PRAGMA foreign_keys = ON; PRAGMA synchronous = FULL; PRAGMA wal_autocheckpoint = 0;"
        "PRAGMA temp_store = MEMORY; PRAGMA cell_size_check = ON; PRAGMA secure_delete = FAST;");
    if (mode == OpenMode::kReadOnly || mode == OpenMode::kImmutable) execute("PRAGMA query_only = ON");
    register_checksum_functions(handle_);
  } catch (...) {
    sqlite3_close_v2(handle_);
    throw;
  }
}

Connection::~Connection() {
  for (auto& [sql, handles] : cache_) {
    for (sqlite3_stmt* handle : handles) sqlite3_finalize(handle);
  }
  sqlite3_close_v2(handle_);
}

Statement Connection::prepare(std::string_view sql) {
  if (const auto cached = cache_.find(sql); cached != cache_.end() && !cached->second.empty()) {
    sqlite3_stmt* handle = cached->second.back();
    cached->second.pop_back();
    return Statement(*this, handle);
  }
  sqlite3_stmt* handle = nullptr;
  const int result = sqlite3_prepare_v3(handle_, sql.data(), static_cast<int>(sql.size()), SQLITE_PREPARE_PERSISTENT,
                                        &handle, nullptr);
  if (result != SQLITE_OK) throw error_of(handle_, result, sql);
  if (handle == nullptr) throw StoreError(StoreErrorKind::kInternal, "empty statement");
  return Statement(*this, handle);
}

void Connection::give_back(sqlite3_stmt* handle) noexcept {
  sqlite3_reset(handle);
  sqlite3_clear_bindings(handle);
  try {
    std::vector<sqlite3_stmt*>& handles = cache_[sqlite3_sql(handle)];
    constexpr std::size_t kKeptPerStatement = 4;
    if (handles.size() < kKeptPerStatement) {
      handles.push_back(handle);
      return;
    }
  } catch (...) {
  }
  sqlite3_finalize(handle);
}

void Connection::execute(const std::string& script) {
  const int result = sqlite3_exec(handle_, script.c_str(), nullptr, nullptr, nullptr);
  if (result != SQLITE_OK) throw error_of(handle_, result, script.substr(0, 200));
}

std::int64_t Connection::query_integer(std::string_view sql) {
  Statement statement = prepare(sql);
  if (!statement.step()) throw StoreError(StoreErrorKind::kInternal, std::string(sql) + ": no row");
  return statement.integer(0);
}

std::int64_t Connection::last_insert_rowid() const { return sqlite3_last_insert_rowid(handle_); }

std::int64_t Connection::changes() const { return sqlite3_changes64(handle_); }

bool Connection::in_transaction() const { return sqlite3_get_autocommit(handle_) == 0; }

void Connection::set_busy_timeout_ms(int timeout_ms) { sqlite3_busy_timeout(handle_, timeout_ms); }

Transaction::Transaction(Connection& connection, Kind kind) : connection_(connection) {
  connection_.prepare(kind == Kind::kWrite ? "BEGIN IMMEDIATE" : "BEGIN DEFERRED").run();
  if (kind == Kind::kRead) {
    try {
      // BEGIN DEFERRED takes its snapshot with the first read only.
      connection_.query_integer("PRAGMA schema_version");
    } catch (...) {
      rollback();
      throw;
    }
  }
}

Transaction::~Transaction() { rollback(); }

void Transaction::commit() {
  if (finished_) throw StoreError(StoreErrorKind::kInternal, "the transaction is finished already");
  connection_.prepare("COMMIT").run();
  finished_ = true;
}

void Transaction::rollback() noexcept {
  if (finished_) return;
  finished_ = true;
  // After some errors (a full disk among them) SQLite has rolled back by itself.
  if (connection_.in_transaction()) sqlite3_exec(connection_.handle(), "ROLLBACK", nullptr, nullptr, nullptr);
}

}  // namespace mapweld::sqlite
