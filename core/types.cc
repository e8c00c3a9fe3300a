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

std::string_view to_string(VoteRule rule) {
  switch (rule) {
    case VoteRule::kMin:
      return "min";
    case VoteRule::kProduct:
      return "product";
    case VoteRule::kSignatures:
      return "signatures";
  }
  return "";
}

std::optional<VoteRule> parse_vote_rule(std::string_view word) {
  for (const VoteRule rule : {VoteRule::kMin, VoteRule::kProduct, VoteRule::kSignatures}) {
    if (to_string(rule) == word) return rule;
  }
  return std::nullopt;
}

std::uint32_t default_min_votes(VoteRule rule) { return rule == VoteRule::kSignatures ? 3 : 10; }

}  // namespace mapweld
