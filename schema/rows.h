// How shared values stand in columns.
#pragma once

#include <algorithm>
#include <optional>
#include <string>

#include "core/types.h"
#include "schema/engine/database.h"
#include "schema/engine/store_error.h"
#include "schema/store_types.h"

namespace mapweld::rows {

inline std::int64_t microseconds(Timestamp time) { return time.time_since_epoch().count(); }

inline std::optional<std::int64_t> microseconds(const std::optional<Timestamp>& time) {
  if (!time) return std::nullopt;
  return microseconds(*time);
}

inline Timestamp timestamp(const sqlite::Statement& row, int column) {
  return Timestamp{std::chrono::microseconds{row.integer(column)}};
}

inline std::optional<Timestamp> optional_timestamp(const sqlite::Statement& row, int column) {
  if (row.is_null(column)) return std::nullopt;
  return timestamp(row, column);
}

// The column's CHECK sees to the length.
inline Sha256 sha256(const sqlite::Statement& row, int column) {
  Sha256 hash{};
  const auto blob = row.blob(column);
  std::copy_n(blob.begin(), std::min(blob.size(), hash.size()), hash.begin());
  return hash;
}

// NULL is kNone, as an empty word is.
inline Reason reason(const sqlite::Statement& row, int column) {
  const std::string word = row.optional_text(column).value_or("");
  const std::optional<Reason> known = parse_reason(word);
  if (!known) throw StoreError(StoreErrorKind::kCorrupt, "'" + word + "' is no known reason");
  return *known;
}

}  // namespace mapweld::rows
