// The evaluation as a Markdown page.
#pragma once

#include <string>

#include "server/evaluation/evaluation.h"
#include "server/evaluation/truth_metrics.h"

namespace mapweld::server::evaluation {

// What was compared, with which parameters.
struct ReportHead {
  std::string map_a;
  std::string map_b;
  std::string command;  // that makes it again
  MergeOptions merge;   // method and seed unused
  VerifierOptions verifier;
  std::string verifier_version;
};

// Tables of one row a method: the cost of each level of the final value in verifications, time, modelled time and
// edges, with joined vertices and independent joins, and beside the clairvoyant; quality at a share of the baseline's
// cost; whole merges. Means, with one standard deviation where there are several runs. `truth` may be null.
std::string markdown_report(const ReportHead& head, const Evaluation& evaluation, const TruthResult* truth);

}  // namespace mapweld::server::evaluation
