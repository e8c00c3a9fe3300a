#include "server/jobs/unstored_work.h"

#include <utility>

namespace mapweld::server {

UnstoredWork::UnstoredWork(const MergeState* stored, VertexSet absent)
    : absent_(std::move(absent)), absence_(encode_absence({absent_})) {
  if (stored == nullptr) return;
  edges_stored_ = stored->edges.size();
  mark_ = blobs::mark_of(*stored);
}

void UnstoredWork::keep(CurvePointRow point) {
  if (!curve_.empty() && curve_.back().step == point.step) curve_.pop_back();
  curve_.push_back(std::move(point));
}

CheckpointWrite UnstoredWork::checkpoint_of(const MergeState& state, std::vector<EdgeJudgement> judgements) {
  encoded_ = blobs::encode_merge_state(state, mark_);
  parts_.clear();
  for (const blobs::MergeStatePart& part : encoded_) parts_.push_back({part.name, part.bytes});
  CheckpointWrite checkpoint;
  if (!mark_ && absent_.empty()) checkpoint.dropped_parts = absence_name_;
  if (!mark_ && !absent_.empty()) parts_.push_back({absence_.name, absence_.bytes});
  edges_.clear();
  for (std::size_t i = edges_stored_; i < state.edges.size(); ++i) {
    const MergeEdge& e = state.edges[i];
    edges_.push_back({.u = e.u,
                      .v = e.v,
                      .votes = e.votes,
                      .verification = e.verification,
                      .judgement = std::move(judgements[i - edges_stored_]),
                      .verifications = e.verifications,
                      .elapsed_s = edge_times_s_[i - edges_stored_]});
  }
  checkpoint.step = state.step;
  checkpoint.phase = to_string(state.phase);
  checkpoint.parts = parts_;
  checkpoint.edges = edges_;
  checkpoint.curve_points = curve_;
  return checkpoint;
}

void UnstoredWork::stored(const MergeState& state) {
  mark_ = blobs::mark_of(state);
  edges_stored_ = state.edges.size();
  edge_times_s_.clear();
  curve_.clear();
}

}  // namespace mapweld::server
