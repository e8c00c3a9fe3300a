// The figures of an evaluation: the paper's 5, 6 and 7, and those against a truth; each as SVG, and as CSV what it
// shows.
#pragma once

#include <string>
#include <vector>

#include "server/evaluation/evaluation.h"
#include "server/evaluation/truth_metrics.h"

namespace mapweld::server::evaluation {

struct OutputFile {
  std::string name;  // "figure-5.svg"
  std::string content;
};

// figure-5: quality at a share of the baseline's cost. figure-6: the curves of all runs in one CSV; as SVG over
// verifications, there with the clairvoyant and the bound, over time and over modelled time. levels: what it took to
// reach each, and how many times what it takes the clairvoyant. figure-7: weights of the edges
// in their order while QuickConnect explores (when it did not run, within the baseline's share of figure 5). `pair`
// names the maps. With `memo` nothing is shown over time.
std::vector<OutputFile> figures(const Evaluation& evaluation, const std::string& pair);

// wrong-edges: by method over verifications. precision-recall: over both thresholds. localization: recall at k (CSV).
std::vector<OutputFile> truth_figures(const Evaluation& evaluation, const TruthResult& truth, const std::string& pair);

}  // namespace mapweld::server::evaluation
