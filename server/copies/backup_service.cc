#include "server/copies/backup_service.h"

#include <algorithm>
#include <chrono>
#include <exception>
#include <system_error>
#include <utility>

#include <spdlog/spdlog.h>

#include "client/contract/problem.h"
#include "schema/engine/data_folder.h"
#include "server/http/wire/text.h"
#include "server/services/paging.h"
#include "server/services/times.h"

namespace mapweld::server {
namespace {

namespace fs = std::filesystem;
using contract::ContractError;

constexpr const char* kSuffix = ".db";

[[noreturn]] void refuse_unknown(std::int64_t id) {
  throw ContractError("no_such_backup", "There is no backup " + std::to_string(id) + ".");
}

// "1790000000.db" -> 1790000000.
std::optional<std::int64_t> id_of(const fs::path& file) {
  std::uint64_t id = 0;
  if (file.extension() != kSuffix || !parse_whole(file.stem().string(), id, 10)) return std::nullopt;
  return static_cast<std::int64_t>(id);
}

contract::Backup describe(std::int64_t id, const std::string& state) {
  contract::Backup backup;
  backup.id = id;
  backup.state = state;
  backup.created_at = to_rfc3339(Timestamp{std::chrono::seconds(id)});
  return backup;
}

}  // namespace

BackupService::BackupService(Store& store, fs::path folder) : store_(store), folder_(std::move(folder)) {
  std::error_code none;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder_, none)) {
    if (const auto id = id_of(entry.path())) {
      last_ = std::max(last_, *id);
    } else if (const std::string name = entry.path().filename().string();
               name.ends_with(".db.part") && !store_.is_read_only()) {
      fs::remove(entry.path(), none);
      fs::remove(entry.path().string() + "-journal", none);
    }
  }
}

BackupService::~BackupService() { give_up(); }

contract::Backup BackupService::begin() {
  const std::lock_guard turn(turn_);
  std::int64_t id = 0;
  {
    const std::lock_guard lock(mutex_);
    if (running_) {
      throw ContractError("wrong_state", "Backup " + std::to_string(*running_) + " is being made. Wait for its end.");
    }
    const auto since_1970 = std::chrono::system_clock::now().time_since_epoch();
    id = std::max<std::int64_t>(last_ + 1, std::chrono::duration_cast<std::chrono::seconds>(since_1970).count());
    make_data_folder(folder_);
    last_ = id;
    running_ = id;
    progress_ = 0;
  }
  if (thread_.joinable()) thread_.join();
  stop_ = false;
  thread_ = std::thread([this, id] { make(id); });
  return get(id);
}

void BackupService::make(std::int64_t id) {
  std::string error;
  try {
    const bool whole = store_.backup(file_of(id), [this](double share) {
      progress_ = share;
      return !stop_;
    });
    if (!whole) error = "given up";
  } catch (const StoreError& failure) {
    error = failure.kind() == StoreErrorKind::kNoSpace ? "The disk is full." : "It could not be written.";
    spdlog::error("backup {}: {}", id, failure.what());
  } catch (const std::exception& failure) {
    error = "It could not be written.";
    spdlog::error("backup {}: {}", id, failure.what());
  }
  const std::lock_guard lock(mutex_);
  running_.reset();
  if (!error.empty()) failed_[id] = error;
}

contract::Backup BackupService::get(std::int64_t id) const {
  std::optional<contract::Backup> backup = find(id);
  if (!backup) refuse_unknown(id);
  return *std::move(backup);
}

contract::Page<contract::Backup> BackupService::list(std::size_t limit,
                                                     const std::optional<std::string>& cursor) const {
  const auto last_seen = after<std::int64_t>(cursor);
  std::vector<contract::Backup> rows;
  for (const auto& [id, backup] : all()) {
    if ((!last_seen || id > *last_seen) && rows.size() <= limit) rows.push_back(backup);
  }
  return make_page<contract::Page<contract::Backup>>(
      rows, limit, [](const contract::Backup& backup) { return backup; },
      [](const contract::Backup& backup) { return backup.id; });
}

std::shared_ptr<const OpenFile> BackupService::open(std::int64_t id) const {
  const contract::Backup backup = get(id);
  if (backup.state != "completed") {
    throw ContractError("wrong_state", "Backup " + std::to_string(id) + " is " + backup.state + ".");
  }
  return std::make_shared<const OpenFile>(file_of(id));
}

void BackupService::remove(std::int64_t id) {
  const std::lock_guard turn(turn_);
  const contract::Backup backup = get(id);
  if (backup.state == "running") {
    stop_ = true;
    if (thread_.joinable()) thread_.join();
  }
  std::error_code gone;
  fs::remove(file_of(id), gone);
  const std::lock_guard lock(mutex_);
  failed_.erase(id);
}

fs::path BackupService::file_of(std::int64_t id) const { return folder_ / (std::to_string(id) + kSuffix); }

std::optional<contract::Backup> BackupService::find(std::int64_t id) const {
  std::map<std::int64_t, contract::Backup> backups = all();
  const auto found = backups.find(id);
  return found == backups.end() ? std::nullopt : std::optional(std::move(found->second));
}

std::map<std::int64_t, contract::Backup> BackupService::all() const {
  const std::lock_guard lock(mutex_);
  std::map<std::int64_t, contract::Backup> backups;
  std::error_code none;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder_, none)) {
    const auto id = id_of(entry.path());
    const auto bytes = entry.file_size(none);
    if (!id || none) continue;
    contract::Backup& backup = backups[*id] = describe(*id, "completed");
    backup.progress = 1;
    backup.bytes = static_cast<std::int64_t>(bytes);
  }
  for (const auto& [id, error] : failed_) {
    contract::Backup& backup = backups[id] = describe(id, "failed");
    backup.error = error;
  }
  if (running_) {
    contract::Backup& backup = backups[*running_] = describe(*running_, "running");
    backup.progress = progress_;
  }
  return backups;
}

void BackupService::give_up() noexcept {
  const std::lock_guard turn(turn_);
  stop_ = true;
  if (thread_.joinable()) thread_.join();
}

}  // namespace mapweld::server
