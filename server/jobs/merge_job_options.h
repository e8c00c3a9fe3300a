// How merge jobs are run: with which verifier, how many at once, how often they are measured and written down.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "core/geometry/pair_verifier.h"

namespace mapweld::server {

class MergeListener;

// Makes the verifier that a job's pairs are put to; called once a run.
using VerifierFactory = std::function<std::shared_ptr<const PairVerifier>(const VerifierOptions&)>;

struct MergeJobOptions {
  VerifierFactory verifier;            // required
  int workers = 1;                     // jobs that run at the same time
  int verify_threads = 1;              // on which a job verifies pairs; the merge is the same for any number
  double checkpoint_interval_s = 0.5;  // between checkpoints, where they are cheap enough
  double checkpoint_cost_share = 0.1;  // of a job's time at most: a checkpoint of d seconds waits for d / share more
  double metrics_interval_s = 0.2;     // between exact eigenvalues, and how old what is polled may be
  double metrics_cost_share = 0.1;
  MergeListener* listener = nullptr;            // told what merges do; may be null, else outlives the jobs
  std::function<void(const std::string&)> log;  // told of runs that fail or cannot be stored; may be empty
};

}  // namespace mapweld::server
