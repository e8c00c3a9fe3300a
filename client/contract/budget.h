// How far a merge may go before it stops by itself.
#pragma once

#include <cstdint>
#include <optional>

#include "client/contract/codec.h"

namespace mapweld::contract {

// Absent or null means unlimited; the first limit that is reached stops the merge. In answers only the limits that were
// set are written.
struct Budget {
  static constexpr Code kWrongType = "invalid_budget";

  std::optional<double> seconds;              // of elapsed_s
  std::optional<std::int64_t> verifications;  // exactly so many
  std::optional<std::int64_t> edges;          // inter-map edges
  std::optional<double> fraction_of_maximum;  // of the algebraic connectivity that can be reached; (0, 1]
  std::optional<bool> certified;              // judge the fraction by the certificate, not by the estimate
  static constexpr auto fields() {
    using B = Budget;
    return std::tuple(omitted_when_empty("seconds", &B::seconds),
                      omitted_when_empty("verifications", &B::verifications), omitted_when_empty("edges", &B::edges),
                      omitted_when_empty("fraction_of_maximum", &B::fraction_of_maximum),
                      omitted_when_empty("certified", &B::certified));
  }
  friend bool operator==(const Budget&, const Budget&) = default;
};

// Throws ContractError(invalid_budget) unless every limit is finite and > 0 and the fraction at most 1.
void check(const Budget& budget);

}  // namespace mapweld::contract
