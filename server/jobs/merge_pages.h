// The lists that a merge's readers page through.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "schema/engine/database.h"
#include "server/jobs/merge_status.h"

namespace mapweld::server {

// The number that a page gave as its `next`. MergeJobError "invalid_parameter" for anything else.
std::optional<std::int64_t> parse_cursor(const std::optional<std::string>& cursor);

// The first `limit` of `rows`, which has been read one row further than the page goes; `number` of a row is its cursor.
template <typename Item, typename Row, typename Describe, typename Number>
Page<Item> make_page(const std::vector<Row>& rows, std::size_t limit, const Describe& describe, const Number& number) {
  Page<Item> page;
  for (std::size_t i = 0; i < std::min(limit, rows.size()); ++i) page.items.push_back(describe(rows[i]));
  if (rows.size() > limit && limit > 0) page.next = std::to_string(number(rows[limit - 1]));
  return page;
}

// Of the merge, which exists, what lies after `from`, at most `limit` of them.
Page<MergeCurvePoint> curve_page(const Reader& db, JobId job, std::size_t limit, std::optional<std::int64_t> from);
Page<MergeEdgePoint> edge_page(const Reader& db, JobId job, std::size_t limit, std::optional<std::int64_t> from);

}  // namespace mapweld::server
