// What a merge by `spectral` of made-up maps costs, whatever their size, with a verifier that takes no time.
// docs/spectral.md holds the figures.
#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <ctime>
#include <fstream>
#include <iomanip>
#include <iostream>
#include <limits>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>

#include "core/fingerprint.h"
#include "core/merge/make_merger.h"
#include "core/merge/vote_source.h"
#include "tests/benchmark/simulated_maps.h"

namespace mapweld {
namespace {

double processor_s() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

// A line of /proc/self/status, in MB.
double status_mb(const std::string& name) {
  std::ifstream status("/proc/self/status");
  for (std::string word; status >> word;) {
    double kb = 0;
    if (word == name && status >> kb) return kb / 1e3;
  }
  return 0;
}

// Passes what was taken at the same place of the loop, and nothing else.
class PlaceVerifier final : public PairVerifier {
 public:
  explicit PlaceVerifier(std::uint32_t images) : images_(images) {}
  Verification verify(const AppearanceVector& a, const AppearanceVector& b) const override {
    const int first = (a.width_px - 1) % images_, second = (b.width_px - 1) % images_;
    const int apart = std::abs(first - second);
    Verification verdict;
    verdict.accepted = std::min(apart, images_ - apart) <= kSamePlace;
    verdict.inliers = 20;
    return verdict;
  }
  std::string version() const override { return "place-1"; }
  const VerifierOptions& options() const override { return options_; }

 private:
  static constexpr int kSamePlace = 4;
  int images_;
  VerifierOptions options_;
};

void run_sized(std::uint32_t images, std::uint32_t min_votes, std::uint64_t verifications) {
  MergeInput input = test::simulated_maps(images, images);
  input.options.method = "spectral";
  input.options.min_votes = min_votes;
  input.verifier = std::make_shared<PlaceVerifier>(images);
  input.votes = std::make_shared<WordVotes>(*input.appearances, input.members[0], input.members[1]);
  const double before_mb = status_mb("VmRSS:");
  const auto merger = make_merger(std::move(input));
  const double began_s = processor_s();
  double voted_s = 0, first_s = 0, longest_voting_s = 0, longest_s = 0;
  std::uint64_t longest_at = 0;
  Fingerprint order;
  std::size_t edges = 0;
  double step_began_s = began_s;
  while (!merger->done() && merger->state().verifications < verifications) {
    const MergePhase phase = merger->state().phase;
    const std::uint64_t verified = merger->state().verifications;
    merger->step();
    const double now_s = processor_s(), step_s = now_s - step_began_s;
    step_began_s = now_s;
    double& longest = phase == MergePhase::kVoting ? longest_voting_s : longest_s;
    if (step_s > longest && phase != MergePhase::kVoting) longest_at = verified;
    longest = std::max(longest, step_s);
    const MergeState& state = merger->state();
    if (phase == MergePhase::kVoting && state.phase != phase) voted_s = now_s;
    if (state.verifications == verified) continue;
    if (verified == 0) first_s = now_s;
    const bool passed = state.edges.size() > edges;
    edges = state.edges.size();
    order.add(passed ? std::uint64_t{to_index(state.edges.back().u)} << 32 | to_index(state.edges.back().v)
                     : std::uint64_t{to_index(state.rejected.back().source)} << 32 |
                           to_index(state.rejected.back().target));
  }
  const MergeState& state = merger->state();
  std::cout << std::fixed << std::setprecision(2) << "candidates " << state.candidates_known << ", verifications "
            << state.verifications << ", edges " << state.edges.size() << ", order " << order.value()
            << "\nprocessor time: votes counted after " << voted_s - began_s << " s, first verification after "
            << first_s - began_s << " s, end after " << processor_s() - began_s << " s\nlongest step: of voting "
            << longest_voting_s << " s, then " << longest_s << " s (after " << longest_at
            << " verifications)\nmemory: " << before_mb << " MB before the merger, " << status_mb("VmHWM:")
            << " MB at most\n";
}

}  // namespace
}  // namespace mapweld

int main(int argc, char** argv) {
  CLI::App app("What a merge by `spectral` of two made-up maps costs");
  std::uint32_t images = 20000, min_votes = 9;
  std::uint64_t verifications = std::numeric_limits<std::uint64_t>::max();
  app.add_option("--images", images, "Of each of the two maps")->capture_default_str();
  app.add_option("--min-votes", min_votes, "Fewer: more candidates")->capture_default_str();
  app.add_option("--verifications", verifications, "Ends after so many");
  CLI11_PARSE(app, argc, argv);
  mapweld::run_sized(images, min_votes, verifications);
}
