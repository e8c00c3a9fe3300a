// SQL functions that reckon checksums, known on every connection of ours.
#pragma once

struct sqlite3;

namespace mapweld::sqlite {

// - mapweld_checksum(value, ...): 64 bits over the values in their order, with their types and lengths; XXH3, each
//   value's with what came before as its seed. Two lists of values that differ anywhere have different ones, but for a
//   chance of 2^-64.
// - mapweld_xor(a, b, ...): the exclusive or of integers.
//
// Throws StoreError when SQLite cannot.
void register_checksum_functions(sqlite3* connection);

}  // namespace mapweld::sqlite
