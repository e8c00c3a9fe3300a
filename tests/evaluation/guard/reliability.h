// Is an edge as often right as its confidence says?
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "tests/evaluation/guard/guard_counts.h"

namespace mapweld::evaluation {

struct ReliabilityBin {
  double from = 0, to = 0;  // of confidence: from <= confidence < to, the last with its end
  std::size_t edges = 0, right = 0;
  // Each case weighs at most `most_a_case` edges, so that one dense map does not speak for all.
  double weight = 0, weight_right = 0, weight_confidence = 0;
  double share_right() const { return weight == 0 ? 0 : weight_right / weight; }
  double mean_confidence() const { return weight == 0 ? 0 : weight_confidence / weight; }
};

class Reliability {
 public:
  explicit Reliability(std::size_t most_a_case = 300);
  // Edges between maps. Unknown ones count as right if `unknown_is_right`, otherwise not at all.
  void add(const JudgedMerge& judged, const std::vector<GuardVerdict>& verdicts, bool unknown_is_right);
  const std::vector<ReliabilityBin>& bins() const { return bins_; }

 private:
  std::size_t most_a_case_;
  std::vector<ReliabilityBin> bins_;
};

// Lines of Markdown.
std::string reliability_table(const Reliability& reliability);
// A diagram: share right by mean confidence.
std::string reliability_svg(const Reliability& reliability, const std::string& subtitle);

}  // namespace mapweld::evaluation
