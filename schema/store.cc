#include "schema/store.h"

#include <algorithm>
#include <new>
#include <system_error>
#include <utility>

#include <sqlite3.h>
#include <sys/stat.h>

#include "schema/engine/row_checksums.h"
#include "schema/engine/system_error.h"

namespace mapweld {

using sqlite::Connection;
using sqlite::Transaction;

namespace {

// A commit whose sync failed has its frames in the WAL, whole: a process that died now would find it committed when it
// starts again. So another commit, which changes nothing, is written over them.
void bury_failed_commit(Connection& writer) noexcept {
  try {
    const std::int64_t version = writer.query_integer("PRAGMA user_version");
    Transaction transaction(writer, Transaction::Kind::kWrite);
    writer.execute("PRAGMA user_version = " + std::to_string(version));  // writes the first page, as it is
    transaction.commit();
  } catch (const std::exception&) {
    // What fails again stands in the place of what failed before, if anything could be written at all.
  }
}

}  // namespace

ReadTransaction::ReadTransaction(Store& store, std::unique_ptr<Connection> connection)
    : Reader(connection.get()),
      store_(&store),
      owned_(std::move(connection)),
      transaction_(std::make_unique<Transaction>(*owned_, Transaction::Kind::kRead)) {}

ReadTransaction::ReadTransaction(ReadTransaction&& other) noexcept = default;

ReadTransaction::~ReadTransaction() {
  transaction_.reset();
  if (owned_) store_->give_back(std::move(owned_));
}

WriteTransaction::WriteTransaction(Store& store, bool may_use_reserve)
    : Reader(nullptr), store_(&store), turn_(store.writer_turn_) {
  if (may_use_reserve) store.reserve_.release_when_short();
  connection_ = store.writer_.get();
  if (connection_->in_transaction()) connection_->execute("ROLLBACK");  // the last one's end found no memory
  transaction_ = std::make_unique<Transaction>(*connection_, Transaction::Kind::kWrite);
}

WriteTransaction::WriteTransaction(WriteTransaction&& other) noexcept = default;

WriteTransaction::~WriteTransaction() { rollback(); }

void WriteTransaction::commit() {
  if (!transaction_) throw StoreError(StoreErrorKind::kInternal, "the transaction is finished already");
  store_->refuse_when_gone();
  try {
    transaction_->commit();
  } catch (...) {
    transaction_.reset();
    bury_failed_commit(*connection_);
    throw;
  }
  store_->after_commit();
  transaction_.reset();
  turn_.unlock();
  store_->refuse_when_gone();
}

void WriteTransaction::rollback() noexcept {
  if (!transaction_) return;
  transaction_.reset();
  turn_.unlock();
}

Store::Store(const std::filesystem::path& file, const StoreOptions& options)
    : file_(file),
      wal_(file),
      options_(options),
      reserve_(file.parent_path() / "mapweld.reserve", options.reserve_bytes) {
  wal_ += "-wal";
  next_checkpoint_pages_ = options_.checkpoint_pages;
  next_restart_pages_ = options_.restart_pages;
  opened_ = identity_of(file_);
  if (options_.read_only) return;
  reserve_.release_when_short();  // opening may need room itself
  writer_ = std::make_unique<Connection>(file_, sqlite::OpenMode::kReadWrite);
  writer_->set_busy_timeout_ms(options_.busy_timeout_ms);
  writer_->execute("PRAGMA cache_size = -" + std::to_string(options_.writer_cache_kib));
  const auto mode = [this] {
    sqlite::Statement statement = writer_->prepare("PRAGMA journal_mode = WAL");
    statement.step();
    return std::string(statement.text(0));
  }();
  if (mode != "wal") throw StoreError(StoreErrorKind::kIo, file_.string() + " cannot be kept in WAL mode here");
  // Once the WAL is moved, its file shrinks to this size again.
  writer_->execute("PRAGMA journal_size_limit = " + std::to_string(std::uint64_t{options_.restart_pages} * 4096));
  keep_row_checksums(*writer_);
  reserve_.restore();
  sqlite3_wal_hook(
      writer_->handle(),
      [](void* store, sqlite3*, const char*, int pages) {
        static_cast<Store*>(store)->wal_pages_ = static_cast<std::uint32_t>(pages);
        return SQLITE_OK;
      },
      this);
}

Store::~Store() {
  idle_readers_.clear();
  if (writer_) move_wal(SQLITE_CHECKPOINT_TRUNCATE);
}

WriteTransaction Store::write(Purpose purpose) {
  if (options_.read_only) throw StoreError(StoreErrorKind::kNoPermission, file_.string() + " is opened for reading");
  return WriteTransaction(*this, purpose == Purpose::kDelete);
}

std::optional<Store::Identity> Store::identity_of(const std::filesystem::path& file) {
  struct stat status {};
  if (::stat(file.c_str(), &status) != 0) return std::nullopt;
  return Identity{static_cast<std::uint64_t>(status.st_dev), static_cast<std::uint64_t>(status.st_ino)};
}

bool Store::in_place() const {
  if (!opened_) return true;
  return identity_of(file_) == opened_ && (!wal_known_ || identity_of(wal_) == opened_wal_);
}

void Store::refuse_when_gone() const {
  if (!in_place()) {
    throw StoreError(StoreErrorKind::kGone, file_.string() + " was removed, replaced or unmounted while it is in use");
  }
}

ReadTransaction Store::read() {
  std::unique_ptr<Connection> reader;
  {
    const std::lock_guard lock(mutex_);
    if (!idle_readers_.empty()) {
      reader = std::move(idle_readers_.back());
      idle_readers_.pop_back();
    }
  }
  if (!reader) reader = open_reader();
  return ReadTransaction(*this, std::move(reader));
}

std::unique_ptr<Connection> Store::open_reader() {
  refuse_when_gone();  // another database may stand there
  auto reader = std::make_unique<Connection>(
      file_, options_.immutable ? sqlite::OpenMode::kImmutable : sqlite::OpenMode::kReadOnly);
  reader->set_busy_timeout_ms(options_.busy_timeout_ms);
  reader->execute("PRAGMA cache_size = -" + std::to_string(options_.reader_cache_kib));
  return reader;
}

void Store::give_back(std::unique_ptr<Connection> reader) noexcept {
  if (reader->in_transaction()) return;  // its end found no memory
  const std::lock_guard lock(mutex_);
  if (idle_readers_.size() < options_.idle_readers) idle_readers_.push_back(std::move(reader));
}

StoreStatistics Store::statistics() const {
  const std::lock_guard lock(mutex_);
  return statistics_;
}

constexpr int kBackupPages = 1'024;  // copied before it is asked whether to go on

bool Store::backup(const std::filesystem::path& target, const GoesOn& goes_on) {
  if (std::filesystem::exists(target)) {
    throw StoreError(StoreErrorKind::kConstraint, target.string() + " exists already");
  }
  std::filesystem::path part = target;
  part += ".part";
  std::error_code ignored;
  std::filesystem::remove(part, ignored);
  bool whole = false;
  try {
    const ReadTransaction from = read();
    Connection to(part, sqlite::OpenMode::kCreate);
    sqlite3_backup* copy = sqlite3_backup_init(to.handle(), "main", from.connection().handle(), "main");
    if (copy == nullptr) throw sqlite::error_of(to.handle(), SQLITE_ERROR, "backup");
    int result = SQLITE_OK;
    bool goes = true;
    while (goes && result == SQLITE_OK) {
      result = sqlite3_backup_step(copy, kBackupPages);
      const double pages = std::max(1, sqlite3_backup_pagecount(copy));
      goes = !goes_on || goes_on(1 - sqlite3_backup_remaining(copy) / pages);
    }
    sqlite3_backup_finish(copy);
    whole = goes && result == SQLITE_DONE;
    if (result != SQLITE_DONE && result != SQLITE_OK) throw sqlite::error_of(to.handle(), result, "backup");
  } catch (...) {
    std::filesystem::remove(part, ignored);
    throw;
  }
  if (!whole) {
    std::filesystem::remove(part, ignored);
    return false;
  }
  std::filesystem::rename(part, target);
  sync_folder(std::filesystem::absolute(target).parent_path());
  return true;
}

void Store::limit_pages(std::uint32_t pages) {
  const std::lock_guard turn(writer_turn_);
  writer_->query_integer("PRAGMA max_page_count = " + std::to_string(pages));
}

void Store::after_commit() noexcept {
  if (wal_pages_ < wal_pages_before_) next_checkpoint_pages_ = options_.checkpoint_pages;  // it has started over
  wal_pages_before_ = wal_pages_;
  if (wal_pages_ >= next_checkpoint_pages_) {
    next_checkpoint_pages_ = wal_pages_ + options_.checkpoint_pages;
    // The WAL starts over when all of it is moved and nobody reads it any more. Under unbroken reading that moment has
    // to be waited for, lest it grow without end; while a reader stays, ever more seldom.
    if (wal_pages_ < next_restart_pages_) {
      move_wal(SQLITE_CHECKPOINT_PASSIVE);
    } else {
      next_restart_pages_ = move_wal(SQLITE_CHECKPOINT_RESTART) ? options_.restart_pages : 2 * wal_pages_;
    }
  }
  if (!wal_known_) {
    // A WAL that is gone already is none that will be there: what in_place() compares it with never comes.
    opened_wal_ = identity_of(wal_).value_or(Identity{});
    wal_known_ = true;
  }
  constexpr std::uint64_t kCommitsBetweenLooks = 64;
  if (++commits_ % kCommitsBetweenLooks == 0) reserve_.restore();
  const std::lock_guard lock(mutex_);
  statistics_.commits = commits_;
  statistics_.wal_pages = wal_pages_;
}

bool Store::move_wal(int how) noexcept {
  constexpr int kWaitForReadersMs = 250;
  sqlite3_busy_timeout(writer_->handle(), kWaitForReadersMs);
  int pages = 0;
  int moved = 0;
  const int result = sqlite3_wal_checkpoint_v2(writer_->handle(), nullptr, how, &pages, &moved);
  std::string error;
  if (result != SQLITE_OK) {
    try {
      error = sqlite3_errmsg(writer_->handle());
    } catch (const std::bad_alloc&) {  // counted all the same
    }
  }
  sqlite3_busy_timeout(writer_->handle(), options_.busy_timeout_ms);

  const std::lock_guard lock(mutex_);
  ++statistics_.wal_checkpoints;
  // Readers in the way are no failure: what could be moved has been.
  if (result != SQLITE_OK && (result & 0xff) != SQLITE_BUSY) {
    ++statistics_.failed_wal_checkpoints;
    statistics_.last_wal_checkpoint_error = std::move(error);
  }
  return result == SQLITE_OK && moved == pages;
}

}  // namespace mapweld
