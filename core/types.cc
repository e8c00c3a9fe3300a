#include "core/types.h"

namespace mapweld {

std::string_view to_string(Reason reason) {
  switch (reason) {
    case Reason::kNone:
      return "";
    case Reason::kTooFewFeatures:
      return "too_few_features";
    case Reason::kNoCandidate:
      return "no_candidate";
    case Reason::kTooFewInliers:
      return "too_few_inliers";
    case Reason::kNotSignificant:
      return "not_significant";
    case Reason::kInconsistent:
      return "inconsistent";
    case Reason::kUnsupported:
      return "unsupported";
    case Reason::kAmbiguous:
      return "ambiguous";
  }
  return "";
}

}  // namespace mapweld
