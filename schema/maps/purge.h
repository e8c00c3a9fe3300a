// Removing deleted vertices for good, for when nobody else has the store open.
#pragma once

#include <cstdint>
#include <filesystem>

#include "schema/store.h"
#include "schema/store_types.h"

namespace mapweld {

struct PurgeStatistics {
  std::uint64_t vertices = 0;
  std::uint64_t edges = 0;     // of them, inner and inter
  std::uint64_t segments = 0;  // written anew without them
  std::uint64_t merges = 0;    // whose stored state has other verdicts now, and whose search begins anew
};

// Removes the deleted vertices of a plain map: rows, bytes, appearances, postings and edges of all levels of merging.
// Their numbers stay taken, their names are free. What merges keep of them are pairs of numbers with a verdict; answers
// that are kept of the map (answer_store.h) go.
PurgeStatistics purge_deleted(WriteTransaction& db, MapId map);

// Writes a database file anew, with what is in it and nothing of what was, and empties its WAL. Nobody may have a
// transaction open. Needs room for a copy where SQLite has its temporary files (TMPDIR), and for another in the WAL.
// Interrupted, nothing is lost. Throws StoreError.
void rewrite_database(const std::filesystem::path& file);

}  // namespace mapweld
