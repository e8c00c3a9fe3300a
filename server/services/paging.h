// Cursors of lists whose items are numbered: the cursor is the last number read.
#pragma once

#include <charconv>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "client/contract/problem.h"

namespace mapweld::server {

inline std::int64_t parse_cursor(std::string_view cursor) {
  std::int64_t number = 0;
  const auto [end, error] = std::from_chars(cursor.data(), cursor.data() + cursor.size(), number);
  if (error != std::errc{} || end != cursor.data() + cursor.size() || number < 0) {
    throw contract::ContractError("invalid_parameter", "\"cursor\" is not one that a page gave.");
  }
  return number;
}

// Where a list goes on: after an item of this id.
template <typename Id>
std::optional<Id> after(const std::optional<std::string>& cursor) {
  if (!cursor) return std::nullopt;
  return static_cast<Id>(parse_cursor(*cursor));
}

// Turns rows, read one more than `limit`, into a page. `describe(row)` makes an item, `number(row)` its cursor.
template <typename Page, typename Rows, typename Describe, typename Number>
Page make_page(const Rows& rows, std::size_t limit, const Describe& describe, const Number& number) {
  Page page;
  for (std::size_t i = 0; i < rows.size() && i < limit; ++i) page.items.push_back(describe(rows[i]));
  if (rows.size() > limit) page.next_cursor = std::to_string(number(rows[limit - 1]));
  return page;
}

}  // namespace mapweld::server
