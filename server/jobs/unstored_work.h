// What a run of a merge has done and not stored yet, and the checkpoint that it makes.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "core/merge/merge_state.h"
#include "schema/blobs/merge_state_blob.h"
#include "schema/maps/edge_store.h"
#include "schema/merges/merge_state_store.h"
#include "schema/merges/merge_store.h"
#include "server/jobs/merge_watch.h"

namespace mapweld::server {

class UnstoredWork {
 public:
  // `stored`: the state that the run goes on from; null: it begins.
  UnstoredWork(const MergeState* stored, VertexSet absent);

  // Nothing of the state is stored in a form that could be added to: the next checkpoint has all of it.
  void begin_anew() { mark_.reset(); }
  bool begins_anew() const { return !mark_; }

  // The edges of `state` that are not stored, as numbers: [first_edge(), size).
  std::size_t first_edge() const { return edges_stored_; }
  // Of those, so many have their time.
  std::size_t timed_edges() const { return edges_stored_ + edge_times_s_.size(); }
  void time_next_edge(double elapsed_s) { edge_times_s_.push_back(elapsed_s); }

  // Keeps a point of the curve, instead of the last one where that is of the same step.
  void keep(CurvePointRow point);

  // What is to be written; without what is spent and the verifier. Good until the next call of anything here. Every
  // edge must have its time. `judgements`: of the edges that are not stored.
  CheckpointWrite checkpoint_of(const MergeState& state, std::vector<EdgeJudgement> judgements);
  // It has been.
  void stored(const MergeState& state);

 private:
  std::optional<blobs::MergeStateMark> mark_;  // what of the state is stored
  std::size_t edges_stored_ = 0;
  std::vector<double> edge_times_s_;
  std::vector<CurvePointRow> curve_;

  // What a checkpoint points to.
  const std::vector<std::string> absence_name_ = {kAbsencePart};
  const VertexSet absent_;
  const blobs::MergeStatePart absence_;
  std::vector<blobs::MergeStatePart> encoded_;
  std::vector<CheckpointPart> parts_;
  std::vector<NewEdge> edges_;
};

}  // namespace mapweld::server
