// What becomes of a verified edge, and why.
#pragma once

#include <cstddef>

#include "core/guard/evidence_model.h"
#include "core/guard/guard_evidence.h"
#include "core/types.h"

namespace mapweld {

struct GuardOptions {
  double min_confidence = kDefaultMinConfidence;  // of a confirmed edge; in [0, 1]
  EvidenceModel model;
  std::size_t most_links = 20;  // of an image, the fullest
};

// `confirmed` is `confidence >= min_confidence`; the reason of what is not is kUnsupported.
struct GuardVerdict {
  Reason reason = Reason::kNone;
  double confidence = 1;  // in [0, 1], four decimals
  GuardEvidence evidence;
  bool confirmed() const { return reason == Reason::kNone; }
  friend bool operator==(const GuardVerdict&, const GuardVerdict&) = default;
};

// The verdict on an edge with these signs and this belief (Beliefs), to which EdgeSigns::on_the_way is added.
GuardVerdict verdict_of(const EdgeSigns& signs, double belief, const GuardOptions& options, bool is_inner);

}  // namespace mapweld
