#include "core/guard/verdict.h"

namespace mapweld {

GuardVerdict verdict_of(const EdgeSigns& signs, double belief, const GuardOptions& options, bool is_inner) {
  GuardVerdict verdict;
  verdict.confidence = confidence_of(belief + signs.on_the_way);
  verdict.reason = verdict.confidence >= options.min_confidence ? Reason::kNone : Reason::kUnsupported;
  verdict.evidence.signs = signs;
  verdict.evidence.parts = weigh(signs, options.model, is_inner);
  verdict.evidence.neighbours = belief - verdict.evidence.parts.sum();
  return verdict;
}

}  // namespace mapweld
