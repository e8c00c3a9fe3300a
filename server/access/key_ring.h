// The keys in force, in memory, as the data folder has them at the moment of asking.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <mutex>
#include <string_view>
#include <vector>

#include "schema/key_store.h"
#include "server/access/caller.h"

namespace mapweld::server {

// Thread-safe.
class KeyRing {
 public:
  // `read_only`: nothing is made in the folder. Throws StoreError.
  explicit KeyRing(const std::filesystem::path& data_folder, bool read_only = false);

  struct Finding {
    // Whether there is or ever was a key: then one is asked for. (Not "is in force": taking back the last key must not
    // open the door.)
    bool has_keys = false;
    std::shared_ptr<const Caller> caller;  // whose key it is; null: no such key is in force
  };
  // A key that was revoked, or made, before the call counts as such. Takes the same time wherever two keys differ.
  // While the file cannot be read the keys are those that they were.
  Finding find(std::string_view key);
  // Those of all keys.
  std::vector<std::shared_ptr<const Caller>> in_force();

 private:
  struct Entry {
    Sha256 sha256{};
    std::shared_ptr<const Caller> caller;
  };
  void refresh();  // with `mutex_` held

  const std::filesystem::path data_folder_;
  std::mutex mutex_;
  KeyStore store_;
  bool is_read_ = false;
  bool has_trouble_ = false;  // told once
  std::int64_t version_ = 0;
  bool has_keys_ = false;
  std::vector<Entry> in_force_;
};

}  // namespace mapweld::server
