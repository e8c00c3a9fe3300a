#include "core/merge/methods/degree_min.h"

#include <algorithm>
#include <bit>
#include <numeric>
#include <stdexcept>
#include <utility>

#include "core/errors.h"
#include "core/merge/methods/random_order.h"
#include "core/random.h"

namespace mapweld {

void DegreeMin::Masses::reset(std::size_t size) {
  mass_.assign(size, 0);
  tree_.assign(size + 1, 0);
  total_ = 0;
}

void DegreeMin::Masses::set(std::uint32_t row, std::uint64_t mass) {
  const std::uint64_t change = mass - mass_[row];  // modulo 2^64
  mass_[row] = mass;
  total_ += change;
  for (std::size_t i = row + 1; i < tree_.size(); i += i & (~i + 1)) tree_[i] += change;
}

std::uint32_t DegreeMin::Masses::row_at(std::uint64_t point) const {
  std::size_t at = 0;
  for (std::size_t bit = std::bit_floor(tree_.size() - 1); bit > 0; bit >>= 1) {
    if (at + bit < tree_.size() && tree_[at + bit] <= point) {
      at += bit;
      point -= tree_[at];
    }
  }
  return static_cast<std::uint32_t>(at);
}

DegreeMin::DegreeMin(MergeInput input) : PairMerger(std::move(input), CountsBeforehand::kForSeveralPairs) {
  begin_pair();
  advance();
}

void DegreeMin::begin_pair() {
  state_.search.similarity = SimilarityMatrix::sparse(votes().rows(), votes().columns());
  state_.search.drawn.assign(votes().rows(), 0);
  state_.phase = MergePhase::kVoting;
}

void DegreeMin::begin_drawing() {
  masses_.reset(votes().rows());
  for (std::uint32_t row = 0; row < votes().rows(); ++row) set_mass(row);
}

void DegreeMin::resume(MergeState state) {
  select_pair(state.pair);
  const PairSearch& search = state.search;
  const SimilarityMatrix& s = search.similarity;
  const bool fits = s.is_sparse() && s.rows() == votes().rows() && s.columns() == votes().columns() &&
                    s.appended_rows() == search.next_row && search.drawn.size() == votes().rows() &&
                    std::ranges::all_of(search.drawn, [this](std::uint32_t n) { return n <= votes().columns(); }) &&
                    search.attempts == std::accumulate(search.drawn.begin(), search.drawn.end(), std::uint64_t{0}) &&
                    (state.phase == MergePhase::kVoting || search.next_row == votes().rows());
  if (!fits) throw FormatError("a merge state whose draws are not of its maps");
  PairMerger::resume(std::move(state));
  if (state_.phase != MergePhase::kVoting) begin_drawing();
}

std::uint64_t DegreeMin::mass_of(std::uint32_t row) const {
  if (state_.search.drawn[row] == votes().columns()) return 0;
  return kUnitMass / std::clamp<std::uint64_t>(graph_.degree(source(row)), 1, kUnitMass);
}

void DegreeMin::set_mass(std::uint32_t row) { masses_.set(row, mass_of(row)); }

void DegreeMin::draw_until_candidate() {
  PairSearch& search = state_.search;
  for (std::uint64_t draws = 0; draws < kDrawsPerStep && masses_.total() > 0; ++draws) {
    std::uint64_t random = state_.random;
    const unsigned __int128 scaled = static_cast<unsigned __int128>(next_random(random)) * masses_.total();
    const std::uint32_t row = masses_.row_at(static_cast<std::uint64_t>(scaled >> 64));
    std::uint64_t key = input_.options.seed + state_.pair;
    const RandomOrder targets(votes().columns(), next_random(key) + row);
    const auto column = static_cast<std::uint32_t>(targets.at(search.drawn[row]));
    const std::uint32_t pair_votes = search.similarity.at(row, column);
    if (pair_votes > 0) verify_final({source(row), target(column), pair_votes});
    state_.random = random;
    ++search.drawn[row];
    ++search.attempts;
    set_mass(row);
    if (pair_votes > 0) return;
  }
}

void DegreeMin::step() {
  if (done()) throw std::logic_error("a merge that is done has no next step");
  if (state_.phase == MergePhase::kVoting) {
    state_.candidates_known += vote_row();
  } else {
    draw_until_candidate();
  }
  ++state_.step;
  advance();
}

void DegreeMin::advance() {
  for (;;) {
    if (state_.phase == MergePhase::kVoting && state_.search.next_row == votes().rows()) {
      state_.phase = MergePhase::kVerification;
      begin_drawing();
    }
    if (state_.phase == MergePhase::kVoting || masses_.total() > 0) return;
    if (!next_pair()) {
      state_.phase = MergePhase::kDone;
      return;
    }
    begin_pair();
  }
}

}  // namespace mapweld
