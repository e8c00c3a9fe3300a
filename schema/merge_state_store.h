// A merge's state, put together from its checkpoint and its inter edges.
#pragma once

#include <optional>

#include "core/merge/merge_state.h"
#include "schema/store.h"
#include "schema/store_types.h"

namespace mapweld {

// The state of the last checkpoint; none before the first. Throws StoreError: kCorrupt when a part or an edge is
// damaged or missing, kNewerVersion.
std::optional<MergeState> load_merge_state(const Reader& db, JobId job);

}  // namespace mapweld
