#include "schema/engine/checksum_function.h"

#include <bit>
#include <cstdint>
#include <span>

#include <sqlite3.h>
#include <xxhash.h>

#include "schema/engine/database.h"

namespace mapweld::sqlite {
namespace {

std::uint64_t hash_number(std::uint64_t bits, std::uint64_t seed) {
  std::uint8_t bytes[8];
  for (std::uint8_t& byte : bytes) {  // little-endian on every processor
    byte = static_cast<std::uint8_t>(bits);
    bits >>= 8;
  }
  return XXH3_64bits_withSeed(bytes, sizeof bytes, seed);
}

std::uint64_t hash_value(sqlite3_value* value, std::uint64_t before) {
  const int type = sqlite3_value_type(value);
  const std::uint64_t seed = before + static_cast<std::uint64_t>(type);
  switch (type) {
    case SQLITE_INTEGER:
      return hash_number(static_cast<std::uint64_t>(sqlite3_value_int64(value)), seed);
    case SQLITE_FLOAT:
      return hash_number(std::bit_cast<std::uint64_t>(sqlite3_value_double(value)), seed);
    case SQLITE_NULL:
      return hash_number(0, seed);
    default: {  // text and blobs: the bytes as they stand
      const void* bytes = sqlite3_value_blob(value);
      return XXH3_64bits_withSeed(bytes, static_cast<std::size_t>(sqlite3_value_bytes(value)), seed);
    }
  }
}

void checksum(sqlite3_context* context, int count, sqlite3_value** values) {
  std::uint64_t hash = 0;
  for (sqlite3_value* value : std::span(values, static_cast<std::size_t>(count))) hash = hash_value(value, hash);
  sqlite3_result_int64(context, static_cast<sqlite3_int64>(hash));
}

void exclusive_or(sqlite3_context* context, int count, sqlite3_value** values) {
  sqlite3_int64 result = 0;
  for (sqlite3_value* value : std::span(values, static_cast<std::size_t>(count))) result ^= sqlite3_value_int64(value);
  sqlite3_result_int64(context, result);
}

}  // namespace

void register_checksum_functions(sqlite3* connection) {
  constexpr int kAnyCount = -1;
  constexpr int kFlags = SQLITE_UTF8 | SQLITE_DETERMINISTIC | SQLITE_INNOCUOUS;
  const auto add = [&](const char* name, auto function) {
    const int result =
        sqlite3_create_function_v2(connection, name, kAnyCount, kFlags, nullptr, function, nullptr, nullptr, nullptr);
    if (result != SQLITE_OK) throw error_of(connection, result, name);
  };
  add("mapweld_checksum", checksum);
  add("mapweld_xor", exclusive_or);
}

}  // namespace mapweld::sqlite
