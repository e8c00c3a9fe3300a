#include "server/api/cursors.h"

#include <array>
#include <stdexcept>

#include <openssl/crypto.h>
#include <openssl/evp.h>
#include <openssl/hmac.h>
#include <openssl/rand.h>

#include "schema/meta_store.h"

namespace mapweld::server {
namespace {

constexpr std::string_view kMetaKey = "cursor_secret";  // hexadecimal
constexpr std::size_t kSealDigits = 32;

std::string new_secret() {
  Sha256 bytes{};
  if (RAND_bytes(bytes.data(), static_cast<int>(bytes.size())) != 1) {
    throw std::runtime_error("the system gives no random numbers");
  }
  return to_hex(bytes);
}

std::string secret_of(Store& store) {
  if (auto secret = find_meta(store.read(), kMetaKey)) return *std::move(secret);
  if (store.is_read_only()) return new_secret();  // cursors live as long as this server
  WriteTransaction db = store.write();
  if (auto secret = find_meta(db, kMetaKey)) return *std::move(secret);
  const std::string secret = new_secret();
  set_meta(db, kMetaKey, secret);
  db.commit();
  return secret;
}

std::string hmac(const std::string& secret, const std::string& text) {
  Sha256 code{};
  unsigned length = 0;
  if (HMAC(EVP_sha256(), secret.data(), static_cast<int>(secret.size()),
           reinterpret_cast<const std::uint8_t*>(text.data()), text.size(), code.data(), &length) == nullptr) {
    throw std::runtime_error("HMAC-SHA256 failed");
  }
  return to_hex(code);
}

// Each piece with its length, so that no two lists are written alike.
void add(std::string& text, std::string_view piece) { text += std::to_string(piece.size()) + ":" + std::string(piece); }

std::string list_of(const Request& request) {
  std::string list;
  add(list, request.path);
  for (const auto& [name, value] : request.query.values()) {
    if (name == "limit" || name == "cursor") continue;
    add(list, name);
    add(list, value);
  }
  return list;
}

}  // namespace

Cursors::Cursors(Store& store) : secret_(secret_of(store)) {}

std::string Cursors::sealed(const Request& request, const std::string& cursor) const {
  return cursor + "." + hmac(secret_, list_of(request) + cursor).substr(0, kSealDigits);
}

PageRequest Cursors::page_in(const Request& request) const {
  PageRequest page;
  page.limit = static_cast<std::size_t>(
      request.query.integer("limit", 1, contract::kMaxPageItems).value_or(contract::kDefaultPageItems));
  const auto given = request.query.text("cursor");
  if (!given) return page;
  page.cursor = given->substr(0, given->find('.'));
  const std::string own = sealed(request, *page.cursor);
  if (own.size() != given->size() || CRYPTO_memcmp(own.data(), given->data(), own.size()) != 0) {
    throw contract::ContractError("invalid_parameter", "\"cursor\" is not one that a page of this list gave.");
  }
  return page;
}

}  // namespace mapweld::server
