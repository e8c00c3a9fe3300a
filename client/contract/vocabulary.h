// Vocabularies and the server's own state.
#pragma once

#include <cstdint>
#include <string>

#include "client/contract/codec.h"

namespace mapweld::contract {

// GET /v1/vocabularies/{v}
struct Vocabulary {
  std::string name;
  std::int64_t words = 0;
  int dimension = 0;
  std::string descriptor;  // "sift"
  std::string sha256;
  std::string index;       // the engine that quantises: "hnsw" or "flann"
  std::string created_at;  // RFC 3339, UTC
  static constexpr auto fields() {
    using V = Vocabulary;
    return std::tuple(field("name", &V::name), field("words", &V::words), field("dimension", &V::dimension),
                      field("descriptor", &V::descriptor), field("sha256", &V::sha256), field("index", &V::index),
                      field("created_at", &V::created_at));
  }
  friend bool operator==(const Vocabulary&, const Vocabulary&) = default;
};

// GET /healthz and /readyz
struct Health {
  std::string status;  // "ok", or what is missing
  static constexpr auto fields() { return std::tuple(field("status", &Health::status)); }
  friend bool operator==(const Health&, const Health&) = default;
};

// GET /version
struct Version {
  std::string version;  // of the program, "0.1.0"
  static constexpr auto fields() { return std::tuple(field("version", &Version::version)); }
  friend bool operator==(const Version&, const Version&) = default;
};

}  // namespace mapweld::contract
