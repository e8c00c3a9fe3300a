#include "core/merge/methods/random_pairs.h"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "core/errors.h"
#include "core/random.h"

namespace mapweld {
namespace {

// Another order for each pair of members.
std::uint64_t key_of(std::uint64_t seed, std::uint32_t pair) {
  std::uint64_t state = seed;
  const std::uint64_t first = next_random(state);
  return first + pair;
}

void require_voted_rows(const MergeState& state, const VoteSource& votes) {
  const PairSearch& search = state.search;
  const SimilarityMatrix& s = search.similarity;
  const bool fits = s.is_sparse() && s.rows() == votes.rows() && s.columns() == votes.columns() &&
                    s.appended_rows() == search.next_row &&
                    (state.phase == MergePhase::kVoting || search.next_row == votes.rows());
  if (!fits) throw FormatError("a merge state whose similarity matrix is not of its maps");
}

}  // namespace

RandomPairs::RandomPairs(MergeInput input) : PairMerger(std::move(input), CountsBeforehand::kForSeveralPairs) {
  begin_pair();
  advance();
}

void RandomPairs::begin_pair() {
  state_.search.similarity = SimilarityMatrix::sparse(votes().rows(), votes().columns());
  state_.phase = MergePhase::kVoting;
  order_ = {std::uint64_t{votes().rows()} * votes().columns(), key_of(input_.options.seed, state_.pair)};
}

void RandomPairs::resume(MergeState state) {
  select_pair(state.pair);
  begin_pair();
  require_voted_rows(state, votes());
  if (state.search.attempts > order_.size()) throw FormatError("a merge state with more attempts than pairs");
  PairMerger::resume(std::move(state));
}

bool RandomPairs::find_candidate(std::uint64_t& from, Candidate& candidate) const {
  const std::uint64_t end = std::min(order_.size(), from + kLookUpsPerStep);
  while (from < end) {
    const std::uint64_t pair = order_.at(from++);
    const auto row = static_cast<std::uint32_t>(pair / votes().columns());
    const auto column = static_cast<std::uint32_t>(pair % votes().columns());
    const std::uint32_t pair_votes = state_.search.similarity.at(row, column);
    if (pair_votes == 0) continue;
    candidate = {source(row), target(column), pair_votes};
    return true;
  }
  return false;
}

void RandomPairs::upcoming(std::size_t most, std::vector<Candidate>& candidates) const {
  std::uint64_t from = state_.search.attempts;
  Candidate candidate;
  // As many pairs as a batch takes are looked at ahead, should they be as rare as that.
  for (int steps = 0; steps < 4 && candidates.size() < most && from < order_.size();) {
    if (find_candidate(from, candidate)) {
      candidates.push_back(candidate);
    } else {
      ++steps;
    }
  }
}

void RandomPairs::step() {
  if (done()) throw std::logic_error("a merge that is done has no next step");
  if (state_.phase == MergePhase::kVoting) {
    state_.candidates_known += vote_row();
  } else {
    std::uint64_t attempts = state_.search.attempts;
    Candidate candidate;
    if (find_candidate(attempts, candidate)) verify_final(candidate);
    state_.search.attempts = attempts;
  }
  ++state_.step;
  advance();
}

void RandomPairs::advance() {
  for (;;) {
    if (state_.phase == MergePhase::kVoting && state_.search.next_row == votes().rows()) {
      state_.phase = MergePhase::kVerification;
    }
    if (state_.phase == MergePhase::kVoting || state_.search.attempts < order_.size()) return;
    if (!next_pair()) {
      state_.phase = MergePhase::kDone;
      return;
    }
    begin_pair();
  }
}

RandomCandidates::RandomCandidates(MergeInput input)
    : PairMerger(std::move(input), CountsBeforehand::kForSeveralPairs) {
  begin_pair();
  advance();
}

void RandomCandidates::begin_pair() {
  state_.search.similarity = SimilarityMatrix::sparse(votes().rows(), votes().columns());
  state_.phase = MergePhase::kVoting;
}

void RandomCandidates::begin_drawing() {
  order_ = {state_.search.similarity.kept_columns().size(), key_of(input_.options.seed, state_.pair)};
}

void RandomCandidates::resume(MergeState state) {
  select_pair(state.pair);
  require_voted_rows(state, votes());
  PairMerger::resume(std::move(state));
  if (state_.phase != MergePhase::kVoting) begin_drawing();
  if (state_.phase != MergePhase::kVoting && state_.search.attempts > order_.size()) {
    throw FormatError("a merge state with more attempts than candidates");
  }
}

Candidate RandomCandidates::drawn(std::uint64_t attempt) const {
  const SimilarityMatrix& s = state_.search.similarity;
  const std::uint64_t cell = order_.at(attempt);
  const auto row = std::ranges::upper_bound(s.offsets(), cell) - s.offsets().begin() - 1;
  return {source(static_cast<std::uint32_t>(row)), target(s.kept_columns()[cell]), s.votes()[cell]};
}

void RandomCandidates::upcoming(std::size_t most, std::vector<Candidate>& candidates) const {
  for (std::uint64_t i = state_.search.attempts; i < order_.size() && candidates.size() < most; ++i) {
    candidates.push_back(drawn(i));
  }
}

void RandomCandidates::step() {
  if (done()) throw std::logic_error("a merge that is done has no next step");
  if (state_.phase == MergePhase::kVoting) {
    state_.candidates_known += vote_row();
  } else {
    verify_final(drawn(state_.search.attempts));
    ++state_.search.attempts;
  }
  ++state_.step;
  advance();
}

void RandomCandidates::advance() {
  for (;;) {
    if (state_.phase == MergePhase::kVoting && state_.search.next_row == votes().rows()) {
      state_.phase = MergePhase::kVerification;
      begin_drawing();
    }
    if (state_.phase == MergePhase::kVoting || state_.search.attempts < order_.size()) return;
    if (!next_pair()) {
      state_.phase = MergePhase::kDone;
      return;
    }
    begin_pair();
  }
}

}  // namespace mapweld
