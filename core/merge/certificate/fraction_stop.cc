#include "core/merge/certificate/fraction_stop.h"

#include <algorithm>
#include <vector>

#include "core/merge/certificate/pass_rate.h"

namespace mapweld {

std::optional<std::vector<OpenCandidate>> open_with_chances(const Merger& merger) {
  const std::optional<std::vector<Candidate>> left = merger.open_candidates();
  if (!left) return std::nullopt;
  const PassRate rate(merger.state());
  std::vector<OpenCandidate> open;
  open.reserve(left->size());
  for (const Candidate& c : *left) open.push_back({c.source, c.target, rate.chance(c.votes)});
  return open;
}

std::optional<Certificate> certify(const Merger& merger) {
  const auto open = open_with_chances(merger);
  if (!open) return std::nullopt;
  return certify(merger.graph(), *open);
}

std::uint64_t next_fraction_test(std::uint64_t verifications) {
  constexpr std::uint64_t kFewest = 128;
  std::uint64_t test = 0;
  while (test <= verifications) test += std::max(kFewest, test / 8);
  return test;
}

bool is_fraction_test(std::uint64_t verifications) {
  return verifications > 0 && next_fraction_test(verifications - 1) == verifications;
}

StopCondition stop_at_fraction(double fraction, bool certified) {
  // Between two verifications the certificate stays what it is, once all votes are in: a test that failed is not made
  // again.
  const auto holds = [fraction, certified, failed_at = std::uint64_t{0}](const Merger& merger) mutable {
    const std::uint64_t verifications = merger.state().verifications;
    if (verifications == failed_at || !is_fraction_test(verifications)) return false;
    const std::optional<Certificate> now = certify(merger);
    if (!now) return false;
    const bool reached = certified ? now->joinable_vertices == 0 && now->certified_fraction >= fraction
                                   : now->likely_joinable_vertices == 0 && now->estimated_fraction >= fraction;
    if (!reached) failed_at = verifications;
    return reached;
  };
  return stop_when_merger(holds, StopReason::kFractionOfMaximum);
}

}  // namespace mapweld
