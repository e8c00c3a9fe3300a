// Small checks that the requests share; each throws ContractError with a detail that names the field.
#pragma once

#include <cstdint>
#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>

#include "client/contract/json.h"
#include "client/contract/problem.h"

namespace mapweld::contract {

// An absent value passes.
inline void check_range(const std::optional<int>& value, std::string_view field, int least, int most) {
  if (!value || (*value >= least && *value <= most)) return;
  throw ContractError("invalid_parameter", "\"" + std::string(field) + "\" must be " + std::to_string(least) + " to " +
                                               std::to_string(most) + ", not " + std::to_string(*value) + ".");
}

// An absent value passes.
inline void check_range(const std::optional<double>& value, std::string_view field, double least, double most) {
  if (!value || (*value >= least && *value <= most)) return;
  throw ContractError("invalid_parameter", "\"" + std::string(field) + "\" must be " + Json(least).dump() + " to " +
                                               Json(most).dump() + ", not " + Json(*value).dump() + ".");
}

// An absent value passes.
inline void check_one_of(const std::optional<std::string>& value, std::string_view field,
                         std::initializer_list<std::string_view> words) {
  if (!value) return;
  std::string choices;
  for (const std::string_view word : words) {
    if (*value == word) return;
    choices += (choices.empty() ? "\"" : ", \"") + std::string(word) + "\"";
  }
  throw ContractError("invalid_parameter", "\"" + std::string(field) + "\" must be one of " + choices + ".");
}

}  // namespace mapweld::contract
