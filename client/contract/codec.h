// From struct to JSON and back. A document of the contract names its fields once, in a static `fields()`; everything
// else follows from that list: to_json, the lenient reading of answers, the strict reading of requests.
//
//   struct Member {
//     std::string map;
//     std::int64_t watermark = 0;
//     static constexpr auto fields() {
//       return std::tuple(required("map", &Member::map), field("watermark", &Member::watermark));
//     }
//   };
//   Json j = member;                                       // {"map":"lab-a","watermark":1356}
//   auto answer = j.get<Member>();                         // unknown fields are passed over, absent ones keep defaults
//   auto request = read_request<Member>(parse_json(body)); // unknown or missing fields and wrong types are errors
//
// std::optional is null when empty; with `omitted_when_empty` the field is left out instead.
#pragma once

#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <tuple>
#include <type_traits>
#include <utility>
#include <vector>

#include "client/contract/json.h"
#include "client/contract/problem.h"

namespace mapweld::contract {

enum class FieldRule : std::uint8_t {
  kPlain,             // always written; absent in a request: the default stays
  kRequired,          // always written; absent in a request: an error
  kOmittedWhenEmpty,  // for std::optional: written only when it has a value
};

template <class Owner, class Value>
struct Field {
  const char* name;
  Value Owner::*member;
  FieldRule rule;
};

template <class Owner, class Value>
constexpr Field<Owner, Value> field(const char* name, Value Owner::*member) {
  return {name, member, FieldRule::kPlain};
}
template <class Owner, class Value>
constexpr Field<Owner, Value> required(const char* name, Value Owner::*member) {
  return {name, member, FieldRule::kRequired};
}
template <class Owner, class Value>
constexpr Field<Owner, std::optional<Value>> omitted_when_empty(const char* name, std::optional<Value> Owner::*member) {
  return {name, member, FieldRule::kOmittedWhenEmpty};
}

template <class T>
concept Document = requires {
  T::fields();
};

namespace detail {

template <class T>
struct IsOptional : std::false_type {};
template <class T>
struct IsOptional<std::optional<T>> : std::true_type {};
template <class T>
struct IsVector : std::false_type {};
template <class T>
struct IsVector<std::vector<T>> : std::true_type {};

enum class Reading : std::uint8_t { kAnswer, kRequest };

// Where a value stands in its document ("budget.seconds", "maps[1]") and what a wrong type there is called.
struct Place {
  std::string path;
  Code wrong_type = "invalid_parameter";
  Place inside(const std::string& name) const { return {path.empty() ? name : path + "." + name, wrong_type}; }
  Place at(std::size_t index) const { return {path + "[" + std::to_string(index) + "]", wrong_type}; }
  std::string name() const { return path.empty() ? "The document" : "\"" + path + "\""; }
};

[[noreturn]] void throw_wrong_type(const Place& place, std::string_view expected, const Json& found);
[[noreturn]] void throw_out_of_range(const Place& place);
[[noreturn]] void throw_unknown_field(const Place& place);
[[noreturn]] void throw_missing_field(const Place& place);

template <class T>
Json encode(const T& value) {
  if constexpr (IsOptional<T>::value) {
    return value ? encode(*value) : Json(nullptr);
  } else if constexpr (IsVector<T>::value) {
    Json array = Json::array();
    for (const auto& item : value) array.push_back(encode(item));
    return array;
  } else if constexpr (std::is_same_v<T, std::map<std::string, std::string>>) {
    Json object = Json::object();
    for (const auto& [key, text] : value) object[key] = text;
    return object;
  } else if constexpr (Document<T>) {
    Json object = Json::object();
    std::apply(
        [&](const auto&... described) {
          const auto write = [&](const auto& one) {
            if constexpr (IsOptional<std::remove_cvref_t<decltype(value.*(one.member))>>::value) {
              if (one.rule == FieldRule::kOmittedWhenEmpty && !(value.*(one.member))) return;
            }
            object[one.name] = encode(value.*(one.member));
          };
          (write(described), ...);
        },
        T::fields());
    return object;
  } else {
    return Json(value);
  }
}

template <class T>
void decode_integer(const Json& json, T& value, const Place& place) {
  // A whole number may be written 12, 12.0 or 1.2e1.
  if (json.is_number_float()) {
    const double number = json.get<double>();
    if (number != std::floor(number)) throw_wrong_type(place, "a whole number", json);
    if (!(std::abs(number) <= 9007199254740992.0) || !std::in_range<T>(static_cast<std::int64_t>(number))) {
      throw_out_of_range(place);
    }
    value = static_cast<T>(number);
  } else if (json.is_number_unsigned()) {
    const auto number = json.get<std::uint64_t>();
    if (!std::in_range<T>(number)) throw_out_of_range(place);
    value = static_cast<T>(number);
  } else if (json.is_number_integer()) {
    const auto number = json.get<std::int64_t>();
    if (!std::in_range<T>(number)) throw_out_of_range(place);
    value = static_cast<T>(number);
  } else {
    throw_wrong_type(place, "a whole number", json);
  }
}

template <class T>
void decode(const Json& json, T& value, const Place& place, Reading reading) {
  if constexpr (IsOptional<T>::value) {
    if (json.is_null()) {
      value.reset();
    } else {
      decode(json, value.emplace(), place, reading);
    }
  } else if constexpr (IsVector<T>::value) {
    if (!json.is_array()) throw_wrong_type(place, "an array", json);
    value.clear();
    for (std::size_t i = 0; i < json.size(); ++i) decode(json[i], value.emplace_back(), place.at(i), reading);
  } else if constexpr (std::is_same_v<T, std::map<std::string, std::string>>) {
    if (!json.is_object()) throw_wrong_type(place, "an object of strings", json);
    value.clear();
    for (const auto& [key, text] : json.items()) decode(text, value[key], place.inside(key), reading);
  } else if constexpr (Document<T>) {
    Place here = place;
    if constexpr (requires { T::kWrongType; }) here.wrong_type = T::kWrongType;
    if (!json.is_object()) throw_wrong_type(here, "an object", json);
    std::apply(
        [&](const auto&... described) {
          if (reading == Reading::kRequest) {
            for (const auto& [key, unused] : json.items()) {
              if (!((key == described.name) || ...)) throw_unknown_field(here.inside(key));
            }
          }
          const auto read = [&](const auto& one) {
            const auto found = json.find(one.name);
            if (found != json.end()) {
              decode(*found, value.*(one.member), here.inside(one.name), reading);
            } else if (one.rule == FieldRule::kRequired && reading == Reading::kRequest) {
              throw_missing_field(here.inside(one.name));
            }
          };
          (read(described), ...);
        },
        T::fields());
  } else if constexpr (std::is_same_v<T, Json>) {
    value = json;
  } else if constexpr (std::is_same_v<T, bool>) {
    if (!json.is_boolean()) throw_wrong_type(place, "true or false", json);
    value = json.get<bool>();
  } else if constexpr (std::is_integral_v<T>) {
    decode_integer(json, value, place);
  } else if constexpr (std::is_floating_point_v<T>) {
    if (!json.is_number()) throw_wrong_type(place, "a number", json);
    value = json.get<T>();
  } else {
    static_assert(std::is_same_v<T, std::string>, "a type that the contract does not know");
    if (!json.is_string()) throw_wrong_type(place, "a string", json);
    value = json.get<std::string>();
  }
}

}  // namespace detail

template <Document T>
void to_json(Json& json, const T& document) {
  json = detail::encode(document);
}

// Reads an answer: unknown fields are passed over, absent ones keep their defaults (newer servers say more, older ones
// less). Throws ContractError(invalid_parameter, or the document's own code) when a field has a wrong type.
template <Document T>
void from_json(const Json& json, T& document) {
  detail::decode(json, document, detail::Place{}, detail::Reading::kAnswer);
}

// Reads a request strictly. Throws ContractError:
//   malformed_json      the document is not an object
//   unknown_field       the document, or one inside it, has a field that the contract does not know; detail names it
//   invalid_parameter   a field is missing, has a wrong type or is out of its type's range; detail names it
//   invalid_budget      the same inside a budget
// Ranges and names are checked by the request's own `check` (map.h, merge.h).
template <Document T>
T read_request(const Json& json) {
  if (!json.is_object()) throw ContractError("malformed_json", "The body must be a JSON object.");
  T request;
  detail::decode(json, request, detail::Place{}, detail::Reading::kRequest);
  return request;
}

}  // namespace mapweld::contract
