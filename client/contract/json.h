// JSON as the contract uses it: objects keep the order in which their fields were written, so that answers read like
// docs/http-api.md; text from outside is parsed with a bound on its nesting.
#pragma once

#include <string>
#include <string_view>

#include <nlohmann/json.hpp>

namespace mapweld::contract {

using Json = nlohmann::ordered_json;

// The deepest nesting of arrays and objects that a document may have. The deepest of the contract's own has 5.
inline constexpr int kMaxJsonDepth = 32;

// The most fields that one object may have. The contract's own largest, a map's labels, has 64. The library looks
// through the fields before it for each field of an object, so that without a bound a document costs its length
// squared.
inline constexpr std::size_t kMaxJsonFields = 256;

// Parses one JSON text (RFC 8259, UTF-8). Stops at the first bracket that opens level kMaxJsonDepth + 1, before
// anything is built of it, so that hostile nesting costs neither stack nor memory. Throws ContractError: empty_body for
// no bytes or white space alone; malformed_json for everything else that is not one JSON text: syntax, nesting, bytes
// that are not UTF-8, a number beyond double, a key that an object has twice, an object of more than kMaxJsonFields.
Json parse_json(std::string_view text);

// The compact text of a document. Never throws: bytes that are not UTF-8 become U+FFFD.
std::string dump(const Json& document);

}  // namespace mapweld::contract
