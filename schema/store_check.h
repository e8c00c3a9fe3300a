// Proves that what is stored is whole and agrees with itself (`mapweld-server check`).
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "schema/engine/file_check.h"
#include "schema/store.h"
#include "schema/store_types.h"

namespace mapweld {

// Where a finding about a merge's state is: "checkpoints: merge 3".
std::string where_of_checkpoint(JobId job);

struct StoreCheckOptions {
  std::size_t max_findings = 100;                          // stop looking after so many
  std::function<void(std::string_view part)> on_progress;  // told before each part
};

struct StoreCheckReport {
  std::vector<Finding> findings;  // none: everything is in order
  std::uint64_t maps = 0;
  std::uint64_t images = 0;
  std::uint64_t appearances = 0;  // vertices whose appearances were read
  std::uint64_t segments = 0;
  std::uint64_t edges = 0;
  std::uint64_t checkpoints = 0;  // parts
};

// Looks at one state of the database: SQLite's own integrity and foreign keys; checksums of all rows and blobs, SHA-256
// of vocabularies and images; numbers without gaps, counters, edge ends and member spans; that the segments hold
// exactly the postings of the appearances they cover; and that merges' states agree with the rows beside them. Changes
// nothing; may run beside a server. Damage is a finding, never an exception.
StoreCheckReport check_store(const Reader& db, const StoreCheckOptions& options = {});

}  // namespace mapweld
