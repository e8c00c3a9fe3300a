// What a running merge has reached of what it can reach: certificate and estimate, of the confirmed layer.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "core/merge/certificate/certificate.h"
#include "core/merge/certificate/final_estimate.h"
#include "core/merge/certificate/forecast.h"
#include "core/merge/merger.h"

namespace mapweld {

// What is thought of each edge of a merger's state, in its order; a function of that state. Empty: all are confirmed.
using EdgeJudge = std::function<std::vector<EdgeStanding>(const Merger&)>;

// Follows one merge. Both speak of the graph of confirmed edges; what has no verdict and what is verified and not
// confirmed counts as open. Nothing is told while there are votes still to be counted, nor before there is anything to
// tell of: while no candidate lies within the largest component and others could still join it. A function of the
// merger's state; one thread.
class Outlook {
 public:
  explicit Outlook(EdgeJudge judge = {}) : judge_(std::move(judge)) {}
  std::optional<Certificate> certificate(const Merger& merger);
  // Something whenever the certificate is.
  std::optional<FinalEstimate> estimate(const Merger& merger);

 private:
  void look(const Merger& merger);

  EdgeJudge judge_;
  Forecast forecast_;
  // As looked at last:
  std::optional<std::uint64_t> step_;
  std::vector<EdgeStanding> standings_;
  AppearanceGraph graph_;  // of confirmed edges
  LargestComponentConnectivity largest_;
  std::optional<Certificate> certificate_;  // none: nothing to tell
};

}  // namespace mapweld
