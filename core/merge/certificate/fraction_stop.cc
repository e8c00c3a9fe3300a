#include "core/merge/certificate/fraction_stop.h"

#include <algorithm>
#include <memory>
#include <utility>

namespace mapweld {

std::uint64_t next_fraction_test(std::uint64_t verifications, std::uint64_t candidates) {
  constexpr std::uint64_t kFewest = 16, kMostTests = 256;
  const std::uint64_t fewest = std::max(kFewest, candidates / kMostTests);
  std::uint64_t test = 0;
  while (test <= verifications) test += std::max(fewest, test / 4);
  return test;
}

bool is_fraction_test(std::uint64_t verifications, std::uint64_t candidates) {
  return verifications > 0 && next_fraction_test(verifications - 1, candidates) == verifications;
}

StopCondition stop_at_fraction(double fraction, bool certified, EdgeJudge judge) {
  // Between two verifications the outlook stays what it is, once all votes are in: a test that failed is not made
  // again.
  const auto holds = [fraction, certified, outlook = std::make_shared<Outlook>(std::move(judge)),
                      failed_at = std::uint64_t{0}](const Merger& merger) mutable {
    const std::uint64_t verifications = merger.state().verifications;
    if (verifications == failed_at || !is_fraction_test(verifications, merger.candidates_total().value_or(0))) {
      return false;
    }
    const std::optional<Certificate> now = outlook->certificate(merger);
    if (!now) return false;
    bool reached = false;
    if (certified) {
      reached = now->joinable_vertices == 0 && now->certified_fraction >= fraction;
    } else {
      const FinalEstimate estimate = outlook->estimate(merger).value();
      reached = estimate.fraction >= fraction && estimate.vertices_share >= fraction;
    }
    if (!reached) failed_at = verifications;
    return reached;
  };
  return stop_when_merger(holds, StopReason::kFractionOfMaximum);
}

}  // namespace mapweld
