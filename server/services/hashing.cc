#include "server/services/hashing.h"

#include <stdexcept>

#include <openssl/evp.h>

namespace mapweld::server {

namespace {

void require(int result) {
  if (result != 1) throw std::runtime_error("SHA-256 failed");
}

}  // namespace

Sha256Hash::Sha256Hash() : context_(EVP_MD_CTX_new()) {
  require(context_ ? EVP_DigestInit_ex(context_.get(), EVP_sha256(), nullptr) : 0);
}

void Sha256Hash::update(std::span<const std::uint8_t> bytes) {
  require(EVP_DigestUpdate(context_.get(), bytes.data(), bytes.size()));
}

Sha256 Sha256Hash::finish() {
  Sha256 hash{};
  require(EVP_DigestFinal_ex(context_.get(), hash.data(), nullptr));
  return hash;
}

void Sha256Hash::Free::operator()(evp_md_ctx_st* context) const { EVP_MD_CTX_free(context); }

Sha256 sha256(std::span<const std::uint8_t> bytes) {
  Sha256Hash hash;
  hash.update(bytes);
  return hash.finish();
}

std::string to_hex(const Sha256& hash) {
  constexpr char kDigits[] = "0123456789abcdef";
  std::string out;
  for (const std::uint8_t byte : hash) {
    out.push_back(kDigits[byte >> 4]);
    out.push_back(kDigits[byte & 15]);
  }
  return out;
}

}  // namespace mapweld::server
