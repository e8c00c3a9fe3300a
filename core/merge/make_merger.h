// Merges by the name of their method: fresh ones, resumed ones, and those whose maps have grown.
#pragma once

#include <memory>

#include "core/merge/merge_input.h"
#include "core/merge/merge_state.h"
#include "core/merge/merger.h"

namespace mapweld {

// A fresh merge. Throws std::invalid_argument for an unknown method, fewer than two members, or options out of range.
std::unique_ptr<Merger> make_merger(MergeInput input);

// Goes on from `state`. Throws FormatError when it belongs to another method, other members or other options. A state
// of a program that went through several pairs of members one after the other where there is one order now keeps its
// verdicts, and its search begins anew, as if its members had grown: its input_fingerprint is then another one.
std::unique_ptr<Merger> make_merger(MergeInput input, MergeState state);

// A merge whose members have grown since `before` (a state of the same merge: method, options and verifier; merged
// numbers stay, new vertices have new ones). The search for candidates begins anew; every verdict stays, is not asked
// for again, and counts as made. At its end there are the edges of a fresh merge of the grown maps. Throws FormatError
// when `before` belongs to another merge.
std::unique_ptr<Merger> make_grown_merger(MergeInput input, MergeState before);

}  // namespace mapweld
