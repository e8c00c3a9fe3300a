#include "core/merge/spectral/spectral.h"

#include <algorithm>
#include <stdexcept>

#include "core/errors.h"

namespace mapweld {

Spectral::Spectral(MergeInput input, const SpectralOptions& options)
    : PairMerger(std::move(input), CountsBeforehand::kNever),
      options_(options),
      blocks_(input_.members),
      open_(pairs().size(), 0) {
  options_.serves_certificate |= input_.options.serves_certificate;
  state_.phase = MergePhase::kVoting;
  advance();
}

void Spectral::step() {
  const PairSearch& search = state_.search;
  switch (state_.phase) {
    case MergePhase::kVoting:
      keep_row();
      break;
    case MergePhase::kVerification:
      if (!order_ && !make_order(options_.odds_at_once)) return;
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
    if (is_known(candidate.source, candidate.target)) continue;
    search.postponed.push_back(candidate);
    ++open_[state_.pair];
  }
  ++search.next_row;
}

void Spectral::advance() {
  while (state_.phase == MergePhase::kVoting && state_.search.next_row == votes().rows()) {
    if (next_votes()) continue;
    state_.phase = MergePhase::kVerification;
  }
  if (state_.phase == MergePhase::kVerification &&
      state_.verifications == inherited() + state_.search.postponed.size()) {
    state_.phase = MergePhase::kDone;
  }
}

// Goes on to the votes of the next pair; false after the last. The candidates of all pairs stay together.
bool Spectral::next_votes() {
  std::vector<Candidate> candidates = std::move(state_.search.postponed);
  const bool has_next = next_pair();
  state_.search.postponed = std::move(candidates);
  return has_next;
}

std::size_t Spectral::pair_of(VertexId u, VertexId v) const {
  return place_of_pair(member_of(u), member_of(v), input_.members.size());
}

CandidateEvidence::Cell Spectral::cell_of(const Candidate& candidate) const {
  const std::size_t pair = pair_of(candidate.source, candidate.target);
  return {blocks_.first_row[pair] + row(candidate.source), blocks_.first_column[pair] + column(candidate.target),
          candidate.votes};
}

std::uint32_t Spectral::find(VertexId source, VertexId target) const {
  const CandidateEvidence::Cell cell = cell_of({source, target, 0});
  return order_->find(cell.row, cell.column);
}

// With the edges that there were when verifications began. Works out the odds of so many candidates more; false while
// there are others.
bool Spectral::make_order(std::size_t candidates) {
  if (!making_) {
    making_ = std::make_unique<Making>();
    making_->inner = AppearanceGraph(graph_.vertices(), input_.inner_edges);
    making_->cells.reserve(state_.search.postponed.size());
    for (const Candidate& c : state_.search.postponed) making_->cells.push_back(cell_of(c));
    making_->odds.emplace(making_->inner, blocks_.sources, blocks_.targets, making_->cells);
  }
  if (!making_->odds->advance(candidates)) return false;
  std::vector<float> odds = making_->odds->take();
  making_->odds.reset();
  AppearanceGraph graph = std::move(making_->inner);
  for (std::uint64_t i = 0; i < state_.inherited_edges; ++i) {
    const MergeEdge& e = state_.edges[i];
    graph.add_edge(e.u, e.v, static_cast<std::uint32_t>(e.verification.inliers));
  }
  order_.emplace(std::move(graph), blocks_.sources, blocks_.targets, std::move(making_->cells), std::move(odds),
                 options_);
  making_.reset();
  return true;
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
  order_->note({find(candidate.source, candidate.target), passed});
  --open_[pair_of(candidate.source, candidate.target)];
  ++search.pending_next;
}

void Spectral::upcoming(std::size_t most, std::vector<Candidate>& candidates) const {
  const PairSearch& search = state_.search;
  for (std::size_t i = search.pending_next; i < search.pending.size() && candidates.size() < most; ++i) {
    candidates.push_back(search.pending[i]);
  }
  if (!order_) return;
  for (const std::uint32_t c : order_->expected()) {
    if (candidates.size() >= most) return;
    candidates.push_back(search.postponed[c]);
  }
}

std::vector<Candidate> Spectral::candidates_left() const {
  if (!order_) return state_.search.postponed;
  std::vector<Candidate> left;
  for (std::uint32_t c = 0; c < order_->size(); ++c) {
    if (!order_->has_verdict(c)) left.push_back(state_.search.postponed[c]);
  }
  return left;
}

std::vector<bool> Spectral::finished_pairs() const {
  std::vector<bool> finished(open_.size());
  for (std::size_t pair = 0; pair < open_.size(); ++pair) {
    const bool has_votes = state_.phase != MergePhase::kVoting || pair < state_.pair;
    finished[pair] = has_votes && open_[pair] == 0;
  }
  return finished;
}

namespace {

void refuse_unless(bool is_good) {
  if (!is_good) throw FormatError("a merge state whose candidates are not of its maps");
}

}  // namespace

void Spectral::resume(MergeState state) {
  PairMerger::resume(std::move(state));
  const PairSearch& search = state_.search;
  std::ranges::fill(open_, 0);
  std::pair<std::uint32_t, std::uint32_t> before{};
  for (std::size_t i = 0; i < search.postponed.size(); ++i) {
    const Candidate& c = search.postponed[i];
    const std::size_t pair = pair_of(c.source, c.target);
    refuse_unless(is_source(c.source, pair) && c.votes >= input_.options.min_votes);
    refuse_unless(pair < state_.pair || (pair == state_.pair && row(c.source) < search.next_row));
    const CandidateEvidence::Cell cell = cell_of(c);
    const std::pair now{cell.row, cell.column};
    refuse_unless(i == 0 || before < now);
    before = now;
    ++open_[pair];
  }
  refuse_unless(inherited() == 0 ? state_.candidates_known == search.postponed.size()
                                 : state_.candidates_known >= search.postponed.size());
  making_.reset();
  order_.reset();
  if (state_.phase == MergePhase::kVoting) {
    refuse_unless(search.pending.empty() && state_.verifications == inherited());
    advance();
    return;
  }
  refuse_unless(state_.pair + 1 == pairs().size() && search.next_row == votes().rows());
  restore_order();
}

void Spectral::restore_order() {
  const PairSearch& search = state_.search;
  if (search.pending.empty() && state_.verifications == inherited()) return;  // the next step makes it
  make_order(search.postponed.size());

  // The verdicts in their order: an edge knows its place, rejected pairs fill the places between.
  std::vector<SpectralOrder::Verdict> verdicts;
  std::vector<bool> is_verified(order_->size(), false);
  const auto add = [&](VertexId u, VertexId v, bool passed) {
    const std::size_t pair = pair_of(u, v);
    const std::uint32_t c = is_source(u, pair) ? find(u, v) : find(v, u);
    refuse_unless(c < order_->size() && !is_verified[c]);
    is_verified[c] = true;
    verdicts.push_back({c, passed});
    --open_[pair];
  };
  std::size_t rejected = state_.inherited_rejected;
  const auto add_rejected_until = [&](std::uint64_t verifications) {
    while (inherited() + verdicts.size() < verifications) {
      refuse_unless(rejected < state_.rejected.size());
      add(state_.rejected[rejected].source, state_.rejected[rejected].target, false);
      ++rejected;
    }
  };
  for (std::size_t i = state_.inherited_edges; i < state_.edges.size(); ++i) {
    const MergeEdge& e = state_.edges[i];
    refuse_unless(member_of(e.u) != member_of(e.v) && inherited() + verdicts.size() < e.verifications);
    add_rejected_until(e.verifications - 1);
    add(e.u, e.v, true);
  }
  add_rejected_until(state_.verifications);

  refuse_unless(!search.pending.empty());
  refuse_unless(search.pending_next <= verdicts.size());
  for (std::size_t i = 0; i < search.pending.size(); ++i) {
    const Candidate& pending = search.pending[i];
    const std::uint32_t c = find(pending.source, pending.target);
    refuse_unless(c < order_->size() && pending == search.postponed[c]);
    refuse_unless(is_verified[c] == (i < search.pending_next));
  }
  order_->restore(verdicts, verdicts.size() - search.pending_next);
}

}  // namespace mapweld
