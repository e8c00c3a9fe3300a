// Whether merges could go on from what is stored of them (`mapweld-server check`).
#pragma once

#include <string>
#include <vector>

#include "schema/merges/merge_store.h"
#include "schema/store.h"
#include "server/jobs/merge_job_options.h"

namespace mapweld::server {

struct MergeCheck {
  std::vector<std::string> findings;  // what is damaged, a line each
  std::vector<std::string> notes;     // what keeps the merge from going on without being damage
};

// Loads the merge and makes its merger, as a run does before its first step, and counts the votes of its edges again
// from the images; nothing is verified. A cancelled merge, which never goes on, and one without a checkpoint are not
// looked at. Costs time and memory as the beginning of a run does. Damage is a finding, never an exception.
MergeCheck check_merge(const Reader& db, const MergeRow& merge, const VerifierFactory& verifier);

}  // namespace mapweld::server
