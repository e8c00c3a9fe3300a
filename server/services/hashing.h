// SHA-256.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include "schema/store_types.h"

struct evp_md_ctx_st;

namespace mapweld::server {

// Of bytes that come in pieces.
class Sha256Hash {
 public:
  Sha256Hash();
  void update(std::span<const std::uint8_t> bytes);
  Sha256 finish();  // used once

 private:
  struct Free {
    void operator()(evp_md_ctx_st* context) const;
  };
  std::unique_ptr<evp_md_ctx_st, Free> context_;
};

Sha256 sha256(std::span<const std::uint8_t> bytes);

std::string to_hex(const Sha256& hash);

}  // namespace mapweld::server
