// Lists of which a caller may see some rows only.
#pragma once

#include <cstddef>
#include <optional>
#include <utility>

namespace mapweld::server {

// The first `count` rows after `from` that are `visible(row)`; `read(count, from)` reads rows in the order of their
// ids.
template <typename Id, typename Read, typename Visible>
auto read_visible(std::size_t count, std::optional<Id> from, const Read& read, const Visible& visible) {
  decltype(read(count, from)) kept;
  while (true) {
    auto rows = read(count, from);
    const bool is_last = rows.size() < count;
    if (!rows.empty()) from = rows.back().id;
    for (auto& row : rows) {
      if (kept.size() < count && visible(row)) kept.push_back(std::move(row));
    }
    if (is_last || kept.size() >= count) return kept;
  }
}

}  // namespace mapweld::server
