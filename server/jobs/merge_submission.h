// Turning a request into stored rows: what must hold before a merge can begin.
#pragma once

#include <string>

#include "schema/store.h"
#include "schema/store_types.h"
#include "server/jobs/merge_status.h"

namespace mapweld::server {

// What can be told without looking at a map. Throws MergeJobError, and as contract::check(Budget).
void check(const MergeRequest& request);

// A map that a merge begins with is plain, or its own merge is at rest. Throws MergeJobError "wrong_state" otherwise.
void require_settled(const Reader& db, MapId map, const std::string& name);

// Stores job, merged map and watermarks; nothing when it throws. Codes as MergeJobs::submit.
JobId store_submission(WriteTransaction& db, const MergeRequest& request, Timestamp now);

}  // namespace mapweld::server
