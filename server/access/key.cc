#include "server/access/key.h"

#include <array>
#include <cstdint>
#include <stdexcept>

#include <openssl/rand.h>
#include <strings.h>

namespace mapweld::server {

std::string make_key() {
  constexpr char kDigits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789-_";
  std::array<std::uint8_t, 32> bytes{};
  if (RAND_bytes(bytes.data(), static_cast<int>(bytes.size())) != 1) {
    throw std::runtime_error("the system gives no random numbers");
  }
  std::string key = "mw_";
  std::uint32_t bits = 0;
  int count = 0;
  for (const std::uint8_t byte : bytes) {
    bits = bits << 8 | byte;
    for (count += 8; count >= 6; count -= 6) key += kDigits[bits >> (count - 6) & 63];
  }
  if (count > 0) key += kDigits[bits << (6 - count) & 63];
  return key;
}

std::optional<std::string_view> bearer_key(std::string_view authorization) {
  constexpr std::string_view kScheme = "Bearer ";
  if (authorization.size() <= kScheme.size() ||
      ::strncasecmp(authorization.data(), kScheme.data(), kScheme.size()) != 0) {
    return std::nullopt;
  }
  const std::string_view key = authorization.substr(kScheme.size());
  if (key.find_first_of(" ,\t") != std::string_view::npos) return std::nullopt;
  return key;
}

}  // namespace mapweld::server
