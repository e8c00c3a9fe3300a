// Whether what is stored of a merge's state agrees with itself and with the rows beside it.
#pragma once

#include <string>
#include <vector>

#include "schema/merges/merge_store.h"
#include "schema/store.h"

namespace mapweld {

// What is wrong, a line each; nothing when everything agrees. Compares the state with the numbers in the merge's row;
// how many inter edges there are, and when each was inserted, with the verdicts that the state counts; and every
// verdict with the members' vertices below their watermarks. What hangs on images or on the verifier is not looked at.
// Throws StoreError, also kCorrupt for a state that cannot be put together.
std::vector<std::string> check_merge_state(const Reader& db, const MergeRow& merge);

}  // namespace mapweld
