// Mean and spread of repeated measurements.
#pragma once

#include <cmath>
#include <cstdint>
#include <span>

namespace mapweld::server::evaluation {

struct Summary {
  std::uint32_t count = 0;
  double mean = 0;
  double deviation = 0;  // one standard deviation of the sample (n - 1); 0 for fewer than two values
  friend bool operator==(const Summary&, const Summary&) = default;
};

inline Summary summary_of(std::span<const double> values) {
  Summary summary;
  summary.count = static_cast<std::uint32_t>(values.size());
  if (values.empty()) return summary;
  const auto n = static_cast<double>(values.size());
  for (const double value : values) summary.mean += value / n;
  if (values.size() < 2) return summary;
  double squares = 0;
  for (const double value : values) squares += (value - summary.mean) * (value - summary.mean);
  summary.deviation = std::sqrt(squares / (n - 1));
  return summary;
}

}  // namespace mapweld::server::evaluation
