// What the row of a merge keeps as JSON: its parameters, its budget and the numbers to show; and its status.
#pragma once

#include <string>
#include <vector>

#include "schema/maps/map_store.h"
#include "schema/merges/merge_store.h"
#include "server/jobs/merge_status.h"
#include "server/jobs/run_control.h"

namespace mapweld::server {

std::string to_row(const MergeParameters& parameters);
std::string to_row(const MergeBudget& budget);
// What a verifier is interned under (schema/maps/edge_store.h).
std::string to_row(const VerifierOptions& options);
// metrics and words; the other numbers have columns of their own.
std::string to_row(const MergeProgress& progress);

// Throw StoreError kCorrupt for a row that another program has written.
MergeParameters parameters_of(const MergeRow& row);
MergeBudget budget_of(const MergeRow& row);

// The numbers to show, as of the last checkpoint. Throws likewise.
MergeProgress progress_of(const MergeRow& row);

// What of a job's budget is left once `spent` is spent; 0 where it is used up.
MergeBudget remaining_of(const MergeRow& row, const Spent& spent);

// The job as its last checkpoint has it, or, when `live` is given, as it is now.
MergeStatus status_of(const MergeRow& row, const std::vector<MemberRow>& members,
                      const std::optional<MergeProgress>& live, Timestamp now);

}  // namespace mapweld::server
