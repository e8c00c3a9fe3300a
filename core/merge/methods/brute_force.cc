#include "core/merge/methods/brute_force.h"

#include <algorithm>
#include <stdexcept>
#include <utility>

namespace mapweld {

BruteForce::BruteForce(MergeInput input) : PairMerger(std::move(input), CountsBeforehand::kAlways) {
  state_.phase = MergePhase::kVerification;
  advance();
}

std::optional<std::vector<Candidate>> BruteForce::open_candidates() const {
  if (state_.search.next_row < votes().rows()) return std::nullopt;
  return PairMerger::open_candidates();
}

std::vector<Candidate> BruteForce::candidates_left() const {
  const PairSearch& search = state_.search;
  return {search.pending.begin() + static_cast<std::ptrdiff_t>(search.pending_next), search.pending.end()};
}

void BruteForce::upcoming(std::size_t most, std::vector<Candidate>& candidates) const {
  const PairSearch& search = state_.search;
  for (std::size_t i = search.pending_next; i < search.pending.size() && candidates.size() < most; ++i) {
    candidates.push_back(search.pending[i]);
  }
}

void BruteForce::step() {
  if (done()) throw std::logic_error("a merge that is done has no next step");
  PairSearch& search = state_.search;
  if (search.pending_next < search.pending.size()) {
    verify_final(search.pending[search.pending_next]);
    ++search.pending_next;
  } else {
    vote();
  }
  ++state_.step;
  advance();
}

void BruteForce::vote() {
  PairSearch& search = state_.search;
  votes_of_row(votes(), search.next_row, input_.options.votes, row_votes_);
  search.pending.clear();
  search.pending_next = 0;
  for (std::uint32_t column = 0; column < row_votes_.size(); ++column) {
    if (row_votes_[column] >= input_.options.min_votes) {
      search.pending.push_back({source(search.next_row), target(column), row_votes_[column]});
    }
  }
  std::ranges::sort(search.pending, [](const Candidate& a, const Candidate& b) {
    return a.votes != b.votes ? a.votes > b.votes : a.target < b.target;
  });
  state_.candidates_known += search.pending.size();
  ++search.next_row;
}

void BruteForce::advance() {
  const auto is_exhausted = [this] {
    const PairSearch& search = state_.search;
    return search.next_row == votes().rows() && search.pending_next == search.pending.size();
  };
  while (is_exhausted()) {
    if (next_pair()) continue;
    state_.phase = MergePhase::kDone;
    return;
  }
}

}  // namespace mapweld
