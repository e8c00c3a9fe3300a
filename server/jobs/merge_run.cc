#include "server/jobs/merge_run.h"

#include <algorithm>
#include <chrono>
#include <exception>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <thread>
#include <utility>
#include <vector>

#include "core/merge/certificate/fraction_stop.h"
#include "core/merge/run.h"
#include "schema/engine/store_error.h"
#include "schema/merges/merge_store.h"
#include "server/jobs/merge_eta.h"
#include "server/jobs/merge_input_loader.h"
#include "server/jobs/merge_job_rows.h"
#include "server/jobs/merge_listener.h"
#include "server/jobs/merge_watch.h"
#include "server/jobs/pacer.h"
#include "server/jobs/unstored_work.h"
#include "server/services/times.h"

namespace mapweld::server {
namespace {

using Clock = std::chrono::steady_clock;

constexpr double kPublishInterval_s = 0.02;
constexpr double kLeastMetricsInterval_s = 0.005;
constexpr double kMetricsShareOfPast = 0.05;  // a young merge changes fast: measure again after this share of its age
constexpr double kCurveSpacing =
    1.02;  // a point of the curve is kept when so much more time has passed than at the last

// A full disk is tried again after kSpaceSlices slices; in between the run listens.
constexpr std::chrono::milliseconds kSpaceSlice{50};
constexpr int kSpaceSlices = 10;

// The job was deleted, or claimed by somebody else: this run has nothing to say any more.
struct FencedOff {};

RunEnd end_of_failure(const std::string& error) { return {JobState::kFailed, "error", error, now()}; }

class Run {
 public:
  Run(Store& store, JobId job, RunControl& control, const MergeJobOptions& options, LoadedMerge loaded)
      : store_(store),
        job_(job),
        control_(control),
        listener_(options.listener),
        row_(std::move(loaded.row)),
        checkpoints_(options.checkpoint_interval_s, options.checkpoint_cost_share),
        metrics_pacer_(options.metrics_interval_s, options.metrics_cost_share / 2),
        certificate_pacer_(options.metrics_interval_s, options.metrics_cost_share / 2),
        metrics_interval_s_(options.metrics_interval_s),
        log_(options.log),
        work_(loaded.state ? &*loaded.state : nullptr, std::move(loaded.absent)) {
    std::optional<std::uint64_t> fingerprint;
    if (loaded.state) {
      fingerprint = loaded.state->input_fingerprint;
      if (begins_anew(loaded)) work_.begin_anew();
      row_.granted_at.edges = granted_edges_in(row_.granted_at.edges, row_.spent.edges, loaded.state->edges.size());
      progress_.checkpoint_step = row_.step;
      const std::chrono::duration<double> age =
          row_.checkpoint_at ? now() - *row_.checkpoint_at : Timestamp::duration{};
      progress_.checkpoint_at = Clock::now() - std::chrono::duration_cast<Clock::duration>(age);
    }
    merger_ = open_merger(loaded);
    // The search of a former version begins anew too.
    if (fingerprint != merger_->state().input_fingerprint) work_.begin_anew();
    verifications_before_ = merger_->state().verifications;
    const MergeProgress before = progress_of(row_);
    revoked_before_ = before.revoked;
    candidates_known_before_ = before.candidates_known;
    is_guarded_ = loaded.guard != nullptr;
    watch_ = std::make_unique<MergeWatch>(*merger_, std::move(loaded.guard), std::move(loaded.judgements));
  }

  void execute() {
    began_ = Clock::now();
    refresh_metrics();
    if (work_.begins_anew()) {
      keep_curve_point();
      save(std::nullopt);
    } else {
      publish();
      checkpoints_.put_off(elapsed_s());
    }
    const std::optional<StopReason> reason = run(*merger_, stop_condition(), [this](const Merger&) { after_step(); });
    finish(reason);
  }

 private:
  double elapsed_s() const {
    return row_.spent.elapsed_s + std::chrono::duration<double>(Clock::now() - began_).count();
  }

  StopCondition stop_condition() {
    const MergeBudget budget = budget_of(row_);
    std::vector<StopCondition> conditions;
    conditions.push_back(stop_when([this] { return control_.command() != RunCommand::kNone; }, StopReason::kPaused));
    if (budget.verifications) {
      conditions.push_back(stop_at_verifications(row_.granted_at.verifications + *budget.verifications));
    }
    if (budget.edges) conditions.push_back(stop_at_edges(row_.granted_at.edges + *budget.edges));
    if (budget.fraction_of_maximum) {
      conditions.push_back(stop_at_fraction(*budget.fraction_of_maximum, budget.certified.value_or(false),
                                            [this](const Merger&) { return watch_->standings(); }));
    }
    if (budget.seconds) {
      limit_s_ = row_.granted_at.elapsed_s + *budget.seconds;
      // The last metrics and the last checkpoint are part of the budget: leave them the time that they took before,
      // but not so much that nothing else gets done.
      const double most_s = std::max(0.0, limit_s_ - row_.spent.elapsed_s) / 2;
      conditions.push_back(
          stop_when([this, most_s] { return elapsed_s() + std::min(finish_cost_s(), most_s) >= limit_s_; },
                    StopReason::kSeconds));
    }
    return stop_at_first(std::move(conditions));
  }

  double finish_cost_s() const { return metrics_cost_s_ + certificate_cost_s_ + checkpoint_cost_s_; }

  void after_step() {
    const double now_s = elapsed_s();
    const MergeState& state = merger_->state();
    for (std::size_t edge = work_.timed_edges(); edge < state.edges.size(); ++edge) {
      work_.time_next_edge(now_s);
      if (listener_) listener_->on_edge(job_, state.step, point_of(edge, !is_guarded_));
    }
    const bool phase_changed = state.phase != measured_phase_;
    const bool leaves_time = now_s + metrics_cost_s_ + certificate_cost_s_ + finish_cost_s() < limit_s_;
    if (leaves_time && (phase_changed || metrics_pacer_.due(now_s))) {
      refresh_metrics();
      if (certificate_pacer_.due(now_s)) refresh_certificate();
      if (phase_changed || now_s >= last_curve_s_ * kCurveSpacing) keep_curve_point();
      publish();
    } else if (now_s >= published_s_ + kPublishInterval_s) {
      publish();
    }
    if (checkpoints_.due(now_s)) save(std::nullopt);
  }

  void refresh_metrics(bool exact = false) {
    const double began_s = elapsed_s();
    const MergeState& state = merger_->state();
    const bool had_new_edges = measured_edges_ != state.edges.size();
    watch_->measure_edges(exact);
    measured_edges_ = state.edges.size();
    progress_.metrics = watch_->metrics();
    progress_.confirmed = watch_->confirmed_edges();
    progress_.revoked = revoked_before_ + watch_->revoked();
    progress_.members = watch_->members();
    tell_verdicts();
    progress_.certified = watch_->certified();
    if (had_new_edges) metrics_cost_s_ = elapsed_s() - began_s;
    measured_phase_ = state.phase;
    const double interval_s = std::clamp(began_s * kMetricsShareOfPast,
                                         std::min(kLeastMetricsInterval_s, metrics_interval_s_), metrics_interval_s_);
    metrics_pacer_.set_interval(interval_s);
    certificate_pacer_.set_interval(interval_s);
    metrics_pacer_.done(began_s, elapsed_s());
  }

  // The edge as events tell it.
  MergeEdgePoint point_of(std::size_t edge, bool confirmed) const {
    const MergeEdge& e = merger_->state().edges[edge];
    MergeEdgePoint point{.u = e.u,
                         .v = e.v,
                         .votes = e.votes,
                         .inliers = static_cast<std::uint32_t>(e.verification.inliers),
                         .verifications = e.verifications,
                         .elapsed_s = elapsed_s(),
                         .confirmed = confirmed,
                         .confidence = {},
                         .doubt = {}};
    return point;
  }

  void tell_verdicts() {
    if (!listener_) return;
    for (const MergeWatch::Change& change : watch_->tell_changes()) {
      MergeEdgePoint point = point_of(change.edge, change.verdict.confirmed());
      point.confidence = change.verdict.confidence;
      point.doubt = to_string(change.verdict.reason);
      listener_->on_verdict(job_, merger_->state().step, point);
    }
  }

  void refresh_certificate() {
    const double began_s = elapsed_s();
    watch_->measure_certificate();
    progress_.certified = watch_->certified();
    certificate_cost_s_ = elapsed_s() - began_s;
    certificate_pacer_.done(began_s, elapsed_s());
  }

  void keep_curve_point() {
    const MergeState& state = merger_->state();
    last_curve_s_ = elapsed_s();
    const MergeMetrics& m = progress_.metrics;
    work_.keep({state.step, last_curve_s_, state.verifications, state.edges.size(), progress_.confirmed, m.components,
                m.algebraic_connectivity, m.largest_vertices, m.largest_algebraic_connectivity,
                progress_.certified ? std::optional(progress_.certified->certified_fraction) : std::nullopt,
                std::string(to_string(state.phase))});
  }

  void publish() {
    const MergeState& state = merger_->state();
    published_s_ = elapsed_s();
    progress_.phase = to_string(state.phase);
    progress_.step = state.step;
    progress_.words_done = state.search.words_processed;
    progress_.words_total = merger_->words_total();
    // When a search begins anew what was found and verified before counts until it has been found again.
    progress_.candidates_known = std::max(state.candidates_known, state.verifications);
    if (!merger_->done()) progress_.candidates_known = std::max(progress_.candidates_known, candidates_known_before_);
    progress_.verifications = state.verifications;
    progress_.edges = state.edges.size();
    progress_.elapsed_s = published_s_;
    progress_.eta_s = merge_eta_s(merger_->candidates_total(), state.verifications, verifications_before_,
                                  published_s_ - row_.spent.elapsed_s);
    control_.publish(progress_);
    if (listener_) listener_->on_progress(job_, progress_);
  }

  // One transaction: what changed of the state, new edges, curve points, what is spent; and the end of the run, if it
  // is one.
  void save(const std::optional<RunEnd>& end) {
    const double began_s = elapsed_s();
    const MergeState& state = merger_->state();
    publish();
    MergeWatch::Judgements judgements = watch_->tell_judgements(work_.first_edge(), end.has_value());
    CheckpointWrite checkpoint = work_.checkpoint_of(state, std::move(judgements.of_the_new));
    checkpoint.progress = to_row(progress_);
    checkpoint.now = now();
    while_there_is_space([&] {
      WriteTransaction db = store_.write();
      const PairVerifier& verifier = *merger_->input().verifier;
      if (!checkpoint.edges.empty())
        checkpoint.verifier = intern_verifier(db, verifier.version(), to_row(verifier.options()));
      checkpoint.spent = {elapsed_s(), state.verifications, state.edges.size()};
      if (!save_checkpoint(db, job_, control_.epoch(), checkpoint)) throw FencedOff{};
      set_judgements(db, row_.map, judgements.changed);
      if (end && !end_run(db, job_, control_.epoch(), *end)) throw FencedOff{};
      if (end) control_.tell_end(db);
      db.commit();
    });
    work_.stored(state);
    progress_.checkpoint_step = state.step;
    progress_.checkpoint_at = Clock::now();
    publish();
    checkpoint_cost_s_ = elapsed_s() - began_s;
    checkpoints_.done(began_s, elapsed_s());
  }

  // A full disk is waited for: what was found stays in memory, and the time is not the merge's. When the server stops
  // meanwhile, the merge goes on from its last checkpoint at the next start.
  template <typename Write>
  void while_there_is_space(const Write& write) {
    const auto full_since = Clock::now();
    bool told = false;
    while (true) {
      try {
        write();
        break;
      } catch (const StoreError& error) {
        if (error.kind() != StoreErrorKind::kNoSpace) throw;
      }
      if (!told && log_) log_("merge " + std::to_string(to_index(job_)) + " waits: the disk is full");
      told = true;
      progress_.waits_for_space = true;
      control_.publish(progress_);
      for (int slice = 0; slice < kSpaceSlices; ++slice) {
        if (control_.command() == RunCommand::kShutDown || control_.command() == RunCommand::kAbandon)
          throw FencedOff{};
        std::this_thread::sleep_for(kSpaceSlice);
      }
    }
    if (!told) return;
    progress_.waits_for_space = false;
    began_ += Clock::now() - full_since;
    if (log_) log_("merge " + std::to_string(to_index(job_)) + " goes on: there is space again");
  }

  void finish(const std::optional<StopReason>& reason) {
    if (reason && control_.command() == RunCommand::kAbandon) throw FencedOff{};
    if (reason && control_.command() == RunCommand::kShutDown) {
      save(std::nullopt);
      return;
    }
    refresh_metrics(true);
    refresh_certificate();
    keep_curve_point();
    save(end_of(reason));
  }

  RunEnd end_of(const std::optional<StopReason>& reason) const {
    if (!reason) return {JobState::kCompleted, std::nullopt, std::nullopt, now()};
    const std::string word(to_string(*reason));
    if (*reason != StopReason::kPaused) return {JobState::kBudgetExhausted, word, std::nullopt, now()};
    if (control_.command() == RunCommand::kCancel) return {JobState::kCancelled, std::nullopt, std::nullopt, now()};
    return {JobState::kPaused, word, std::nullopt, now()};
  }

  Store& store_;
  JobId job_;
  RunControl& control_;
  MergeListener* const listener_;
  bool is_guarded_ = false;
  MergeRow row_;  // as the run found it
  std::unique_ptr<Merger> merger_;
  std::uint64_t verifications_before_ = 0;  // made when the run began
  std::uint64_t revoked_before_ = 0;        // confirmations, by then
  std::uint64_t candidates_known_before_ = 0;
  Clock::time_point began_;
  Pacer checkpoints_;
  Pacer metrics_pacer_;
  Pacer certificate_pacer_;
  std::unique_ptr<MergeWatch> watch_;
  double metrics_interval_s_;
  std::function<void(const std::string&)> log_;

  UnstoredWork work_;
  MergeProgress progress_;
  std::optional<std::size_t> measured_edges_;
  MergePhase measured_phase_ = MergePhase::kVoting;
  double certificate_cost_s_ = 0;
  double metrics_cost_s_ = 0;     // of the last time that anything had to be measured
  double checkpoint_cost_s_ = 0;  // of the last checkpoint
  double limit_s_ = std::numeric_limits<double>::infinity();
  double last_curve_s_ = 0;
  double published_s_ = 0;
};

// The state of a job that was told to stop while it was being loaded: nothing of the merge has changed.
void end_unloaded(Store& store, JobId job, const RunControl& control) {
  RunEnd end{JobState::kPaused, "paused", std::nullopt, now()};
  if (control.command() == RunCommand::kCancel) end = {JobState::kCancelled, std::nullopt, std::nullopt, now()};
  if (control.command() != RunCommand::kPause && control.command() != RunCommand::kCancel) return;
  WriteTransaction db = store.write();
  if (!end_run(db, job, control.epoch(), end)) return;
  control.tell_end(db);
  db.commit();
}

RunOutcome fail(Store& store, JobId job, const RunControl& control, const std::string& error,
                const MergeJobOptions& options) {
  if (options.log) options.log("merge " + std::to_string(to_index(job)) + " failed: " + error);
  try {
    WriteTransaction db = store.write();
    if (end_run(db, job, control.epoch(), end_of_failure(error))) db.commit();
    return {};
  } catch (const std::exception& also) {
    if (options.log) {
      options.log("merge " + std::to_string(to_index(job)) + ": its failure cannot be stored: " + also.what());
    }
    return {false, error};
  }
}

}  // namespace

RunOutcome run_merge(Store& store, JobId job, RunControl& control, const MergeJobOptions& options,
                     std::shared_ptr<const Executor> executor) {
  try {
    std::optional<LoadedMerge> loaded = load_merge(
        store.read(), job, options.verifier, [&control] { return control.command() != RunCommand::kNone; },
        std::move(executor));
    if (!loaded) {
      end_unloaded(store, job, control);
      return {};
    }
    Run(store, job, control, options, std::move(*loaded)).execute();
    return {};
  } catch (const FencedOff&) {
    return {};
  } catch (const UnusableState& error) {
    const std::string help = "; it cannot go on from there, but a restart begins it afresh";
    return fail(store, job, control, error.what() + help, options);
  } catch (const std::exception& error) {
    return fail(store, job, control, error.what(), options);
  }
}

}  // namespace mapweld::server
