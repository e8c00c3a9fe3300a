// Backups that are made while the server serves, kept as files beside its database until they are deleted.
#pragma once

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "client/contract/backup.h"
#include "client/contract/page.h"
#include "schema/store.h"
#include "server/http/files/file_reply.h"

namespace mapweld::server {

// Thread-safe. One backup is made at a time, by a thread of its own. The files that are there are the backups: those of
// earlier lives of the server too; what a server that stopped left unfinished is gone when it starts. One that failed
// is remembered until the server stops.
class BackupService {
 public:
  // `folder`: made with the first backup, for its owner only. `store` must outlive this.
  BackupService(Store& store, std::filesystem::path folder);
  // Gives up what is being made.
  ~BackupService();
  BackupService(const BackupService&) = delete;
  BackupService& operator=(const BackupService&) = delete;

  // Begins one. wrong_state while another is being made.
  contract::Backup begin();
  contract::Backup get(std::int64_t id) const;  // no_such_backup
  contract::Page<contract::Backup> list(std::size_t limit, const std::optional<std::string>& cursor) const;
  // The bytes of a completed one. no_such_backup; wrong_state of another.
  std::shared_ptr<const OpenFile> open(std::int64_t id) const;
  // Deletes it; one that is being made is given up first. no_such_backup.
  void remove(std::int64_t id);

 private:
  std::filesystem::path file_of(std::int64_t id) const;
  std::optional<contract::Backup> find(std::int64_t id) const;
  std::map<std::int64_t, contract::Backup> all() const;
  void make(std::int64_t id);
  void give_up() noexcept;

  Store& store_;
  const std::filesystem::path folder_;
  mutable std::mutex mutex_;                         // guards what follows
  std::optional<std::int64_t> running_;              // the one that is being made
  std::map<std::int64_t, std::string> failed_ = {};  // and why
  std::int64_t last_ = 0;
  std::mutex turn_;  // of those who begin, give up or wait for the thread; taken first
  std::thread thread_;
  std::atomic<bool> stop_{false};
  std::atomic<double> progress_{0};
};

}  // namespace mapweld::server
