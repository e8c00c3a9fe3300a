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

std::optional<Reason> parse_reason(std::string_view word) {
  for (int value = 0; value <= static_cast<int>(Reason::kAmbiguous); ++value) {
    const auto reason = static_cast<Reason>(value);
    if (to_string(reason) == word) return reason;
  }
  return std::nullopt;
}

}  // namespace mapweld
