#include "core/merge/spectral/spectral.h"

#include <algorithm>
#include <stdexcept>

#include "core/errors.h"

namespace mapweld {

Spectral::Spectral(MergeInput input, const SpectralOptions& options)
    : PairMerger(std::move(input), false), options_(options) {
  begin_pair();
  advance();
}

void Spectral::begin_pair() {
  state_.phase = MergePhase::kVoting;
  order_.reset();
}

void Spectral::step() {
  const PairSearch& search = state_.search;
  switch (state_.phase) {
    case MergePhase::kVoting:
      keep_row();
      break;
    case MergePhase::kVerification:
      search.pending_next == search.pending.size() ? choose_batch() : take_pending();
      break;
    default:
      throw std::logic_error("a merge that is done has no next step");
  }
  ++state_.step;
  advance();
}

void Spectral::keep_row() {
  PairSearch& search = state_.search;
  votes_of_row(votes(), search.next_row, input_.options.votes, row_votes_);
  for (std::uint32_t column = 0; column < row_votes_.size(); ++column) {
    if (row_votes_[column] < input_.options.min_votes) continue;
    ++state_.candidates_known;
    const Candidate candidate{source(search.next_row), target(column), row_votes_[column]};
    if (!is_known(candidate.source, candidate.target)) search.postponed.push_back(candidate);
  }
  ++search.next_row;
}

void Spectral::advance() {
  for (;;) {
    if (state_.phase == MergePhase::kVoting && state_.search.next_row == votes().rows()) {
      state_.phase = MergePhase::kVerification;
      verified_before_ = state_.verifications;
      make_order();
    }
    if (state_.phase == MergePhase::kVoting) return;
    if (state_.verifications - verified_before_ < state_.search.postponed.size()) return;
    if (!next_pair()) {
      state_.phase = MergePhase::kDone;
      return;
    }
    begin_pair();
  }
}

// With the edges that there were when this pair's verifications began.
void Spectral::make_order() {
  std::vector<CandidateEvidence::Cell> cells;
  cells.reserve(state_.search.postponed.size());
  for (const Candidate& c : state_.search.postponed) cells.push_back({row(c.source), column(c.target), c.votes});
  AppearanceGraph graph(graph_.vertices(), input_.inner_edges);
  for (const MergeEdge& e : state_.edges) {
    if (e.verifications > verified_before_) break;
    graph.add_edge(e.u, e.v, static_cast<std::uint32_t>(e.verification.inliers));
  }
  order_.emplace(std::move(graph), sources(), targets(), std::move(cells), options_);
}

void Spectral::choose_batch() {
  PairSearch& search = state_.search;
  search.pending.clear();
  search.pending_next = 0;
  for (const std::uint32_t c : order_->next_batch()) search.pending.push_back(search.postponed[c]);
}

void Spectral::take_pending() {
  PairSearch& search = state_.search;
  const Candidate candidate = search.pending[search.pending_next];
  const bool passed = verify_final(candidate);
  order_->note({order_->find(row(candidate.source), column(candidate.target)), passed});
  ++search.pending_next;
}

void Spectral::upcoming(std::size_t most, std::vector<Candidate>& candidates) const {
  const PairSearch& search = state_.search;
  for (std::size_t i = search.pending_next; i < search.pending.size() && candidates.size() < most; ++i) {
    candidates.push_back(search.pending[i]);
  }
}

std::vector<Candidate> Spectral::candidates_left() const {
  std::vector<Candidate> left;
  for (std::uint32_t c = 0; c < order_->size(); ++c) {
    if (!order_->has_verdict(c)) left.push_back(state_.search.postponed[c]);
  }
  return left;
}

namespace {

void refuse_unless(bool is_good) {
  if (!is_good) throw FormatError("a merge state whose candidates are not of its maps");
}

}  // namespace

void Spectral::resume(MergeState state) {
  PairMerger::resume(std::move(state));
  const PairSearch& search = state_.search;
  const auto cell_of = [this](const Candidate& c) { return std::pair(row(c.source), column(c.target)); };
  for (std::size_t i = 0; i < search.postponed.size(); ++i) {
    const Candidate& c = search.postponed[i];
    refuse_unless(is_source(c.source) && is_target(c.target));
    refuse_unless(c.votes >= input_.options.min_votes && row(c.source) < search.next_row);
    refuse_unless(i == 0 || cell_of(search.postponed[i - 1]) < cell_of(c));
  }
  const bool is_alone = state_.pair == 0 && state_.inherited_edges + state_.inherited_rejected == 0;
  refuse_unless(is_alone ? state_.candidates_known == search.postponed.size()
                         : state_.candidates_known >= search.postponed.size());
  order_.reset();
  if (state_.phase == MergePhase::kVoting) {
    refuse_unless(search.pending.empty());
    advance();
    return;
  }
  refuse_unless(search.next_row == votes().rows());
  restore_order();
}

void Spectral::restore_order() {
  const PairSearch& search = state_.search;
  // Pairs of members are merged one after the other: the verdicts of this one are the last.
  const auto is_of_this_pair = [this](VertexId a, VertexId b) {
    return (is_source(a) && is_target(b)) || (is_source(b) && is_target(a));
  };
  std::size_t first_edge = state_.edges.size(), first_rejected = state_.rejected.size();
  while (first_edge > state_.inherited_edges &&
         is_of_this_pair(state_.edges[first_edge - 1].u, state_.edges[first_edge - 1].v)) {
    --first_edge;
  }
  while (first_rejected > state_.inherited_rejected &&
         is_of_this_pair(state_.rejected[first_rejected - 1].source, state_.rejected[first_rejected - 1].target)) {
    --first_rejected;
  }
  verified_before_ = first_edge + first_rejected;
  make_order();

  // The verdicts in their order: an edge knows its place, rejected pairs fill the places between.
  std::vector<SpectralOrder::Verdict> verdicts;
  std::vector<bool> is_verified(order_->size(), false);
  const auto add = [&](VertexId source, VertexId target, bool passed) {
    const std::uint32_t c = order_->find(row(source), column(target));
    refuse_unless(c < order_->size() && !is_verified[c]);
    is_verified[c] = true;
    verdicts.push_back({c, passed});
  };
  std::size_t rejected = first_rejected;
  const auto add_rejected_until = [&](std::uint64_t verifications) {
    while (verified_before_ + verdicts.size() < verifications) {
      refuse_unless(rejected < state_.rejected.size());
      add(state_.rejected[rejected].source, state_.rejected[rejected].target, false);
      ++rejected;
    }
  };
  for (std::size_t i = first_edge; i < state_.edges.size(); ++i) {
    const MergeEdge& e = state_.edges[i];
    refuse_unless(verified_before_ + verdicts.size() < e.verifications);
    add_rejected_until(e.verifications - 1);
    is_source(e.u) ? add(e.u, e.v, true) : add(e.v, e.u, true);
  }
  add_rejected_until(state_.verifications);

  if (search.pending.empty()) {
    refuse_unless(verdicts.empty());
    return;
  }
  refuse_unless(search.pending_next <= verdicts.size());
  for (std::size_t i = 0; i < search.pending.size(); ++i) {
    const std::uint32_t c = order_->find(row(search.pending[i].source), column(search.pending[i].target));
    refuse_unless(c < order_->size() && search.pending[i] == search.postponed[c]);
    refuse_unless(is_verified[c] == (i < search.pending_next));
  }
  order_->restore(verdicts, verdicts.size() - search.pending_next);
}

}  // namespace mapweld
