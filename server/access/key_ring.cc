#include "server/access/key_ring.h"

#include <utility>

#include <openssl/crypto.h>
#include <spdlog/spdlog.h>

#include "server/services/hashing.h"

namespace mapweld::server {
namespace {

// Not waiting for a command that is just writing: what it has not committed is not so yet.
constexpr int kBusyTimeoutMs = 0;

}  // namespace

KeyRing::KeyRing(const std::filesystem::path& data_folder, bool read_only)
    : data_folder_(data_folder),
      store_(read_only ? KeyStore::open_read_only(data_folder, kBusyTimeoutMs)
                       : KeyStore(data_folder, kBusyTimeoutMs)) {
  const std::lock_guard lock(mutex_);
  refresh();
}

void KeyRing::refresh() {
  try {
    if (!store_.exists()) store_ = KeyStore::open_read_only(data_folder_, kBusyTimeoutMs);  // made since?
    const std::int64_t version = store_.version();
    if (is_read_ && version == version_) return;
    std::vector<Entry> in_force;
    const std::vector<KeyRow> rows = store_.list();
    for (const KeyRow& row : rows) {
      if (row.revoked_at) continue;
      const std::optional<Role> role = parse_role(row.role);
      if (!role) continue;
      in_force.push_back(
          {row.sha256, std::make_shared<Caller>(Caller{
                           .id = row.id, .name = row.name, .role = *role, .quota = row.quota, .maps = row.maps})});
    }
    in_force_ = std::move(in_force);
    has_keys_ = !rows.empty();
    version_ = version;
    is_read_ = true;
    has_trouble_ = false;
  } catch (const StoreError& error) {
    if (!is_read_) throw;
    if (!store_.exists()) has_keys_ = true;  // keys were made since, and nobody can say yet which
    if (error.kind() == StoreErrorKind::kBusy || std::exchange(has_trouble_, true)) return;
    spdlog::error("the keys cannot be read, those of before stay in force: {}", error.what());
  }
}

std::vector<std::shared_ptr<const Caller>> KeyRing::in_force() {
  const std::lock_guard lock(mutex_);
  refresh();
  std::vector<std::shared_ptr<const Caller>> callers;
  for (const Entry& entry : in_force_) callers.push_back(entry.caller);
  return callers;
}

KeyRing::Finding KeyRing::find(std::string_view key) {
  const Sha256 hash = sha256({reinterpret_cast<const std::uint8_t*>(key.data()), key.size()});
  const std::lock_guard lock(mutex_);
  refresh();
  Finding finding{.has_keys = has_keys_, .caller = nullptr};
  for (const Entry& entry : in_force_) {
    if (CRYPTO_memcmp(entry.sha256.data(), hash.data(), hash.size()) == 0) finding.caller = entry.caller;
  }
  return finding;
}

}  // namespace mapweld::server
