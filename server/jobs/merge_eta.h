// How long a merge still takes, told from what it has done.
#pragma once

#include <cstdint>
#include <optional>

namespace mapweld::server {

inline constexpr std::uint64_t kLeastVerificationsForEta = 20;

// Verifications are nearly all of a merge's work. The rate is that of this run, which has lasted `run_s` and began with
// `verifications_before`: steps, checkpoints and metrics included. Nothing while the number of candidates is not known,
// or too few verifications tell a rate.
inline std::optional<double> merge_eta_s(std::optional<std::uint64_t> candidates, std::uint64_t verifications,
                                         std::uint64_t verifications_before, double run_s) {
  if (!candidates) return std::nullopt;
  if (verifications >= *candidates) return 0.0;
  const std::uint64_t done = verifications - verifications_before;
  if (done < kLeastVerificationsForEta) return std::nullopt;
  return run_s / static_cast<double>(done) * static_cast<double>(*candidates - verifications);
}

}  // namespace mapweld::server
