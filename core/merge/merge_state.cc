#include "core/merge/merge_state.h"

namespace mapweld {

std::string_view to_string(MergePhase phase) {
  switch (phase) {
    case MergePhase::kVoting:
      return "voting";
    case MergePhase::kExploration:
      return "exploration";
    case MergePhase::kVerification:
      return "verification";
    case MergePhase::kRefinement:
      return "refinement";
    case MergePhase::kDone:
      return "done";
  }
  return "";
}

}  // namespace mapweld
