#include "server/http/message.h"

#include <algorithm>
#include <charconv>

#include "client/contract/problem.h"
#include "server/http/wire/entity_tag.h"

namespace mapweld::server {

using contract::ContractError;

std::optional<std::string> Query::text(const std::string& name) const {
  const auto [first, last] = values_.equal_range(name);
  if (first == last) return std::nullopt;
  if (std::next(first) != last) throw ContractError("invalid_parameter", "\"" + name + "\" is given twice.");
  return first->second;
}

std::optional<std::int64_t> Query::integer(const std::string& name, std::int64_t min, std::int64_t max) const {
  const std::optional<std::string> value = text(name);
  if (!value) return std::nullopt;
  std::int64_t number = 0;
  const auto [end, error] = std::from_chars(value->data(), value->data() + value->size(), number);
  if (error != std::errc{} || end != value->data() + value->size() || number < min || number > max) {
    throw ContractError("invalid_parameter", "\"" + name + "\" must be a whole number from " + std::to_string(min) +
                                                 " to " + std::to_string(max) + ".");
  }
  return number;
}

std::optional<bool> Query::boolean(const std::string& name) const {
  const std::optional<std::string> value = text(name);
  if (!value) return std::nullopt;
  if (*value == "true" || *value == "1") return true;
  if (*value == "false" || *value == "0") return false;
  throw ContractError("invalid_parameter", "\"" + name + "\" must be true or false.");
}

void Query::refuse_unknown(std::span<const std::string> known) const {
  for (const auto& [name, value] : values_) {
    if (std::find(known.begin(), known.end(), name) == known.end()) {
      throw ContractError("unknown_field", "There is no query parameter \"" + name + "\" here.");
    }
  }
}

bool Request::knows(const std::string& etag) const {
  return (method == "GET" || method == "HEAD") && names_entity_tag(if_none_match, etag);
}

}  // namespace mapweld::server
