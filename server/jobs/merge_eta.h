// How long a merge still takes, told from what it has done.
#pragma once

#include <cstdint>
#include <optional>

namespace mapweld::server {

// Verifications are nearly all of a merge's work; their number is known beforehand by counting all votes once. The rate
// is that of this run, everything included: steps, checkpoints and metrics.
class MergeEta {
 public:
  MergeEta(std::uint64_t candidates, std::uint64_t verifications_before)
      : candidates_(candidates), before_(verifications_before) {}

  // Nothing while fewer than kLeastVerifications tell a rate.
  std::optional<double> seconds(std::uint64_t verifications, double run_s) const {
    if (verifications >= candidates_) return 0.0;
    const std::uint64_t done = verifications - before_;
    if (done < kLeastVerifications) return std::nullopt;
    return run_s / static_cast<double>(done) * static_cast<double>(candidates_ - verifications);
  }

 private:
  static constexpr std::uint64_t kLeastVerifications = 20;
  std::uint64_t candidates_;
  std::uint64_t before_;
};

}  // namespace mapweld::server
