// What a run measures of its merge: metrics, the certificate, what is confirmed, what there is between each two
// members.
#pragma once

#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "core/merge/alias_guard.h"
#include "core/merge/member_table.h"
#include "core/merge/merge_metrics.h"
#include "core/merge/merger.h"
#include "schema/edge_store.h"
#include "server/jobs/run_control.h"

namespace mapweld::server {

// Only looks on: the merge is the same whether and whenever it is asked. Used by one thread.
class MergeWatch {
 public:
  // `merger` must outlive this. With `guards` the alias guard judges its edges, and metrics speak of the confirmed
  // ones.
  MergeWatch(const Merger& merger, bool guards) : merger_(merger), guards_(guards) {}

  // Measures what can have changed since the last time; a certificate that no longer says anything is forgotten. With
  // `exact` every number is computed anew: how often it was asked before then leaves no trace in the last digits.
  void measure_edges(bool exact);
  // To be called after measure_edges, for the same edges.
  void measure_certificate();

  const MergeMetrics& metrics() const { return metrics_; }
  const std::optional<Certified>& certified() const { return certified_; }
  const std::vector<MemberPairSummary>& members() const { return members_; }

  // Why the guard withholds an edge, by its place among the merge's edges; kNone: confirmed. Judges the edges that have
  // come since.
  Reason doubt(std::size_t edge);
  // What is doubted otherwise than when this was last asked, of the first `edges` edges (at first: all of them).
  std::vector<EdgeDoubt> changed_doubts(std::size_t edges);

 private:
  void judge();
  AppearanceGraph confirmed_graph() const;
  std::vector<bool> confirmed() const;

  const Merger& merger_;
  const bool guards_;
  MergeMetricsFollower follower_;
  MergeMetrics metrics_;
  std::optional<Certified> certified_;
  std::pair<std::uint32_t, std::uint32_t> certified_for_;  // components, vertices of the largest
  std::vector<MemberPairSummary> members_;
  std::optional<std::size_t> measured_edges_;
  std::optional<AliasGuard> guard_;  // made when there is an edge to judge
  std::vector<Reason> doubts_;       // guards: by edge
  std::vector<Reason> told_;         // as changed_doubts told them last
};

}  // namespace mapweld::server
