// A data folder with keys in it.
#pragma once

#include <string>

#include <httplib.h>

#include "schema/key_store.h"
#include "server/access/key.h"
#include "server/services/hashing.h"
#include "tests/support/temp_store.h"

namespace mapweld::test {

class KeysUnderTest {
 public:
  // Makes one, as the command does, and returns what is shown of it.
  std::string make(const std::string& name, const std::string& role, const std::string& maps = "*",
                   const KeyQuota& quota = {}) {
    const std::string key = server::make_key();
    KeyRow row;
    row.name = name;
    row.role = role;
    row.maps = maps;
    row.sha256 = server::sha256({reinterpret_cast<const std::uint8_t*>(key.data()), key.size()});
    row.created_at = at(1);
    row.quota = quota;
    store_.add(row);
    return key;
  }
  void set_quota(const std::string& name, const KeyQuota& quota) { store_.set_quota(name, quota); }
  void revoke(const std::string& name) { store_.revoke(name, at(2)); }
  const std::filesystem::path& folder() const { return folder_.path(); }

 private:
  TempFolder folder_;
  KeyStore store_{folder_.path()};
};

inline httplib::Headers bearer(const std::string& key) { return {{"Authorization", "Bearer " + key}}; }

}  // namespace mapweld::test
