// What a run measures of its merge: metrics, the certificate, what is confirmed, what there is between each two
// members.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "core/guard/alias_guard.h"
#include "core/merge/certificate/outlook.h"
#include "core/merge/member_table.h"
#include "core/merge/merge_metrics.h"
#include "core/merge/merger.h"
#include "schema/maps/edge_store.h"
#include "server/jobs/run_control.h"

namespace mapweld::server {

// A confidence that moved by less is not worth a write while a merge runs.
inline constexpr double kTellingConfidence = 0.01;

// Only looks on: the merge is the same whether and whenever it is asked. Used by one thread.
class MergeWatch {
 public:
  // `merger` must outlive this. With a `guard` over its members its edges are judged, and metrics speak of the
  // confirmed ones; without, every edge is confirmed.
  // `written`: what was thought of the edges that the merge goes on from; members may have grown since.
  MergeWatch(const Merger& merger, std::shared_ptr<AliasGuard> guard, std::vector<JudgedEdge> written = {})
      : merger_(merger),
        guard_(std::move(guard)),
        written_(std::move(written)),
        heard_(confirmed_as_written()),
        outlook_([this](const Merger&) { return standings(); }) {}

  // Measures what can have changed since the last time; a certificate that no longer says anything is forgotten. With
  // `exact` every number is computed anew: how often it was asked before then leaves no trace in the last digits.
  void measure_edges(bool exact);
  // To be called after measure_edges, for the same edges.
  void measure_certificate();

  const MergeMetrics& metrics() const { return metrics_; }
  // How many edges were confirmed when they were measured last.
  std::uint64_t confirmed_edges() const { return confirmed_edges_; }
  // How many confirmations were taken back, from one time that the edges were judged to the next, and at first from
  // what was written.
  std::uint64_t revoked() const { return revoked_; }
  const std::optional<Certified>& certified() const { return certified_; }
  const std::vector<MemberPairSummary>& members() const { return members_; }

  // What is thought of each edge of the merger's state, as it stands now; empty without a guard.
  std::vector<EdgeStanding> standings();

  // The edges whose confirmation came or was taken back since this was asked last, or since what was written.
  struct Change {
    std::size_t edge = 0;
    GuardVerdict verdict;
  };
  std::vector<Change> tell_changes();

  // What is thought of the merge's edges now that was not told yet, or is thought otherwise: of the first `stored`
  // ones, whose rows are there, and of those beyond them, in their order. Confidences that moved by less than
  // kTellingConfidence while the edge stayed confirmed, or withheld, wait until `all` is asked for.
  struct Judgements {
    std::vector<JudgedEdge> changed;        // of the first `stored` edges
    std::vector<EdgeJudgement> of_the_new;  // one for each edge from `stored` on
  };
  Judgements tell_judgements(std::size_t stored, bool all);

 private:
  bool guards() const { return guard_ != nullptr; }
  void judge();
  std::vector<bool> confirmed_as_written() const;
  std::uint64_t revoked_of_the_written(const std::vector<GuardVerdict>& verdicts) const;
  bool is_confirmed(std::size_t edge) const { return !guards() || verdicts_[edge].confirmed(); }
  AppearanceGraph confirmed_graph() const;
  void discount_absent();

  const Merger& merger_;
  const std::shared_ptr<AliasGuard> guard_;
  std::vector<JudgedEdge> written_;  // until they are compared
  std::vector<bool> heard_;          // by edge: confirmed when tell_changes was asked last
  Outlook outlook_;
  MergeMetricsFollower follower_;
  MergeMetrics metrics_;
  std::optional<Certified> certified_;
  std::pair<std::uint32_t, std::uint32_t> certified_for_;  // components, vertices of the largest
  double certified_connectivity_ = 0;                      // of the largest
  std::vector<MemberPairSummary> members_;
  std::optional<std::size_t> measured_edges_;
  std::uint64_t confirmed_edges_ = 0;
  std::uint64_t revoked_ = 0;
  std::vector<GuardVerdict> verdicts_;  // guards: by edge
  struct Told {
    double confidence = 0;
    Reason doubt = Reason::kNone;
  };
  std::vector<Told> told_;  // as tell_judgements told them last
};

}  // namespace mapweld::server
