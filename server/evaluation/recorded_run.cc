#include "server/evaluation/recorded_run.h"

#include <atomic>
#include <ctime>
#include <utility>

#include "core/merge/make_merger.h"

namespace mapweld::server::evaluation {
namespace {

// Wall clock would charge a run for whatever else the machine does.
std::int64_t thread_time_ns() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return std::int64_t{now.tv_sec} * 1'000'000'000 + now.tv_nsec;
}

class ClockedVerifier final : public PairVerifier {
 public:
  explicit ClockedVerifier(std::shared_ptr<const PairVerifier> verifier) : verifier_(std::move(verifier)) {}
  Verification verify(const AppearanceVector& a, const AppearanceVector& b) const override {
    const std::int64_t begin_ns = thread_time_ns();
    Verification verdict = verifier_->verify(a, b);
    spent_ns_ += thread_time_ns() - begin_ns;
    return verdict;
  }
  std::string version() const override { return verifier_->version(); }
  const VerifierOptions& options() const override { return verifier_->options(); }
  double spent_s() const { return static_cast<double>(spent_ns_) * 1e-9; }

 private:
  std::shared_ptr<const PairVerifier> verifier_;
  mutable std::atomic<std::int64_t> spent_ns_ = 0;
};

constexpr std::uint64_t kVerificationsBetweenReports = 64;

}  // namespace

double on_axis(const Cost& cost, CostAxis axis, double modelled_verifier_s) {
  switch (axis) {
    case CostAxis::kVerifications:
      return static_cast<double>(cost.verifications);
    case CostAxis::kTime:
      return cost.elapsed_s;
    case CostAxis::kModelledTime:
      break;
  }
  return cost.elapsed_s - cost.verifier_s + static_cast<double>(cost.verifications) * modelled_verifier_s;
}

RecordedRun record_run(MergeInput input, const RunProgress& progress, MergeState* last) {
  RecordedRun run;
  run.method = input.options.method;
  run.seed = input.options.seed;
  const auto verifier = std::make_shared<const ClockedVerifier>(input.verifier);
  input.verifier = verifier;
  const std::int64_t begin_ns = thread_time_ns();
  const std::unique_ptr<Merger> merger = make_merger(std::move(input));
  const auto cost_now = [&] {
    return Cost{merger->state().verifications, static_cast<double>(thread_time_ns() - begin_ns) * 1e-9,
                verifier->spent_s()};
  };
  bool explores = merger->state().phase == MergePhase::kExploration;
  std::uint64_t reported = 0;
  while (!merger->done()) {
    merger->step();
    const MergeState& state = merger->state();
    if (state.edges.size() > run.edges.size()) {
      const Cost cost = cost_now();
      for (std::size_t i = run.edges.size(); i < state.edges.size(); ++i) {
        const MergeEdge& e = state.edges[i];
        run.edges.push_back({e.u,
                             e.v,
                             static_cast<std::uint32_t>(e.verification.inliers),
                             e.votes,
                             {e.verifications, cost.elapsed_s, cost.verifier_s}});
      }
    }
    if (explores && state.phase != MergePhase::kExploration) run.exploration_end = cost_now();
    explores = state.phase == MergePhase::kExploration;
    if (progress && state.verifications >= reported + kVerificationsBetweenReports) {
      reported = state.verifications;
      progress(reported);
    }
  }
  run.cost = cost_now();
  if (progress) progress(run.cost.verifications);
  if (last) *last = merger->state();
  return run;
}

Verification MemoVerifier::verify(const AppearanceVector& a, const AppearanceVector& b) const {
  const Key key{&a, &b};
  {
    const std::lock_guard lock(mutex_);
    if (const auto found = known_.find(key); found != known_.end()) return found->second;
  }
  Verification verdict = verifier_->verify(a, b);
  const std::lock_guard lock(mutex_);
  return known_.try_emplace(key, std::move(verdict)).first->second;
}

}  // namespace mapweld::server::evaluation
