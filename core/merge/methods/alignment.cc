#include "core/merge/methods/alignment.h"

#include <algorithm>
#include <limits>
#include <stdexcept>
#include <utility>

#include "core/errors.h"

namespace mapweld {
namespace {

// The vote at `rank` (0: the lowest) of a row's or column's `all` cells, of which the kept ones have `kept` votes and
// the others `else_votes`, which is less than any of them.
std::uint32_t vote_at(std::vector<std::uint16_t>& kept, std::uint64_t all, std::uint64_t rank,
                      std::uint32_t else_votes) {
  const std::uint64_t others = all - kept.size();
  if (rank < others) return else_votes;
  const auto at = kept.begin() + static_cast<std::ptrdiff_t>(rank - others);
  std::nth_element(kept.begin(), at, kept.end());
  return *at;
}

// The level of every column (is_column) or row. Lines with too few kept cells for another level than the least are not
// gathered at all, which is most of them as a rule.
std::vector<std::uint32_t> levels_of(const SimilarityMatrix& matrix, bool is_column, std::uint32_t percent,
                                     std::uint32_t min_votes) {
  const std::uint32_t lines = is_column ? matrix.columns() : matrix.rows();
  const std::uint64_t cells = is_column ? matrix.rows() : matrix.columns();
  const std::uint64_t rank = cells == 0 ? 0 : std::min(cells - 1, cells * percent / 100);
  const auto for_each_cell = [&](auto&& visit) {
    for (std::uint32_t row = 0; row < matrix.rows(); ++row) {
      for (std::uint64_t k = matrix.offsets()[row]; k < matrix.offsets()[row + 1]; ++k) {
        visit(is_column ? matrix.kept_columns()[k] : row, matrix.votes()[k]);
      }
    }
  };
  std::vector<std::uint32_t> kept(lines, 0);
  for_each_cell([&kept](std::uint32_t line, std::uint16_t) { ++kept[line]; });
  std::vector<std::vector<std::uint16_t>> votes(lines);
  for_each_cell([&](std::uint32_t line, std::uint16_t vote) {
    if (rank + kept[line] >= cells) votes[line].push_back(vote);
  });
  std::vector<std::uint32_t> levels(lines, min_votes - 1);
  for (std::uint32_t line = 0; line < lines; ++line) {
    if (!votes[line].empty()) levels[line] = vote_at(votes[line], cells, rank, min_votes - 1);
  }
  return levels;
}

}  // namespace

Alignment::Alignment(MergeInput input, const Limits& limits)
    : PairMerger(std::move(input), CountsBeforehand::kForSeveralPairs), limits_(limits) {
  begin_pair();
  advance();
}

void Alignment::begin_pair() {
  state_.search.similarity = SimilarityMatrix::sparse(votes().rows(), votes().columns());
  state_.phase = MergePhase::kVoting;
}

std::optional<std::uint64_t> Alignment::candidates_total() const {
  if (state_.phase == MergePhase::kVoting || input_.members.size() > 2) return std::nullopt;
  return state_.candidates_known;
}

void Alignment::upcoming(std::size_t most, std::vector<Candidate>& candidates) const {
  const PairSearch& search = state_.search;
  for (std::size_t i = search.postponed_next; i < search.postponed.size() && candidates.size() < most; ++i) {
    candidates.push_back(search.postponed[i]);
  }
}

void Alignment::resume(MergeState state) {
  select_pair(state.pair);
  const PairSearch& search = state.search;
  const SimilarityMatrix& matrix = search.similarity;
  bool fits = matrix.is_sparse() && matrix.rows() == votes().rows() && matrix.columns() == votes().columns() &&
              matrix.appended_rows() == search.next_row && state.phase != MergePhase::kExploration &&
              state.phase != MergePhase::kRefinement;
  fits = fits && (search.next_row == votes().rows() ||
                  (state.phase == MergePhase::kVoting && search.word_next_row == 0 && search.postponed.empty()));
  fits = fits && (state.phase == MergePhase::kVoting || search.pending.empty());
  if (!fits) throw FormatError("a merge state whose alignments are not of its maps");
  PairMerger::resume(std::move(state));
  if (state_.phase != MergePhase::kVoting) return;
  // What was found once is found again.
  const MergeState expected = state_;
  const std::uint32_t transitions = std::exchange(state_.search.word_next_row, 0);
  state_.search.pending.clear();
  state_.search.postponed.clear();
  const std::uint64_t found_here = expected.search.pending.size() + expected.search.postponed.size();
  state_.candidates_known = state_.pair == 0 ? 0 : state_.candidates_known - found_here;
  for (std::uint32_t i = 0; i < transitions; ++i) {
    if (!align()) break;
  }
  if (state_ != expected) throw FormatError("a merge state whose alignments are not of its similarity matrix");
}

void Alignment::step() {
  PairSearch& search = state_.search;
  switch (state_.phase) {
    case MergePhase::kVoting:
      if (search.next_row < votes().rows()) {
        vote_row();
      } else if (!align()) {
        start_verification();
      }
      break;
    case MergePhase::kVerification:
      verify_final(search.postponed[search.postponed_next]);
      ++search.postponed_next;
      break;
    case MergePhase::kExploration:
    case MergePhase::kRefinement:
    case MergePhase::kDone:
      throw std::logic_error("a merge that is done has no next step");
  }
  ++state_.step;
  advance();
}

void Alignment::advance() {
  for (;;) {
    const bool has_no_images = state_.phase == MergePhase::kVoting && votes().rows() == 0;
    const bool has_verified_all =
        state_.phase == MergePhase::kVerification && state_.search.postponed_next == state_.search.postponed.size();
    if (!has_no_images && !has_verified_all) return;
    if (!next_pair()) {
      state_.phase = MergePhase::kDone;
      return;
    }
    begin_pair();
  }
}

bool Alignment::align() {
  if (!aligner_) {
    aligner_ = std::make_unique<SequenceAligner>(votes().rows(), score_cells(), limits_.sequence);
    is_prepared_ = false;
    is_taken_.assign(state_.search.similarity.kept_columns().size(), false);
  } else if (!is_prepared_) {
    is_prepared_ = aligner_->prepare(limits_.pairs_per_step);
  } else if (!take_next()) {
    return false;
  }
  ++state_.search.word_next_row;
  return true;
}

void Alignment::start_verification() {
  PairSearch& search = state_.search;
  search.postponed.insert(search.postponed.end(), search.pending.begin(), search.pending.end());
  search.pending.clear();
  aligner_.reset();
  is_taken_.clear();
  state_.phase = MergePhase::kVerification;
}

std::vector<ScoredPair> Alignment::score_cells() const {
  const SimilarityMatrix& matrix = state_.search.similarity;
  const auto levels = [&](bool is_column) {
    return levels_of(matrix, is_column, limits_.level_percent, input_.options.min_votes);
  };
  const std::vector<std::uint32_t> row_levels = levels(false), column_levels = levels(true);
  std::vector<ScoredPair> pairs;
  for (std::uint32_t row = 0; row < matrix.rows(); ++row) {
    for (std::uint64_t k = matrix.offsets()[row]; k < matrix.offsets()[row + 1]; ++k) {
      const std::uint32_t column = matrix.kept_columns()[k];
      const auto level = static_cast<std::int32_t>(std::max({row_levels[row], column_levels[column], 1u}));
      const std::int32_t votes = matrix.votes()[k];
      const std::int32_t score = votes <= level ? 0 : std::min(kMostScore, kLevelScore * (votes - level) / level);
      if (score > 0) pairs.push_back({row, column, score});
    }
  }
  return pairs;
}

bool Alignment::take_next() {
  const std::optional<SequenceAlignment> alignment = aligner_->best();
  if (!alignment) return false;
  if (covers_enough(*alignment)) {
    accept(*alignment);
    return true;
  }
  std::vector<SequenceAligner::Position> own;
  for (const ScoredPair& pair : alignment->pairs) own.push_back({pair.row, pair.column});
  aligner_->remove(own);
  return true;
}

bool Alignment::covers_enough(const SequenceAlignment& alignment) const {
  std::uint32_t rows = 1, columns = 1;
  for (std::size_t k = 1; k < alignment.pairs.size(); ++k) {
    rows += alignment.pairs[k].row != alignment.pairs[k - 1].row ? 1 : 0;
    columns += alignment.pairs[k].column != alignment.pairs[k - 1].column ? 1 : 0;
  }
  return rows >= limits_.min_images && columns >= limits_.min_images;
}

void Alignment::accept(const SequenceAlignment& alignment) {
  PairSearch& search = state_.search;
  const SimilarityMatrix& matrix = search.similarity;
  const auto take = [&](std::uint32_t row, std::uint32_t low, std::uint32_t high, auto&& list) {
    const auto columns = matrix.kept_columns();
    const auto begin = columns.begin() + static_cast<std::ptrdiff_t>(matrix.offsets()[row]);
    const auto end = columns.begin() + static_cast<std::ptrdiff_t>(matrix.offsets()[row + 1]);
    for (auto at = std::lower_bound(begin, end, low); at != end && *at <= high; ++at) {
      const auto k = static_cast<std::size_t>(at - columns.begin());
      if (is_taken_[k]) continue;
      is_taken_[k] = true;
      list.push_back({source(row), target(*at), matrix.votes()[k]});
    }
  };
  std::vector<Candidate> own, halo;
  for (const std::uint32_t i : spread_order(static_cast<std::uint32_t>(alignment.pairs.size()))) {
    const ScoredPair& pair = alignment.pairs[i];
    take(pair.row, pair.column, pair.column, own);
  }
  const auto add_saturated = [](std::uint32_t a, std::uint32_t b) {
    return a + std::min(b, std::numeric_limits<std::uint32_t>::max() - a);
  };
  for (const ScoredPair& pair : alignment.pairs) {
    const std::uint32_t last = std::min(matrix.rows() - 1, add_saturated(pair.row, limits_.halo));
    for (std::uint32_t row = pair.row - std::min(pair.row, limits_.halo); row <= last; ++row) {
      take(row, pair.column - std::min(pair.column, limits_.halo), add_saturated(pair.column, limits_.halo), halo);
    }
  }
  std::ranges::sort(halo, [](const Candidate& a, const Candidate& b) {
    return a.votes != b.votes ? a.votes > b.votes : std::pair(a.source, a.target) < std::pair(b.source, b.target);
  });
  std::vector<SequenceAligner::Position> gone;
  for (const auto* list : {&own, &halo}) {
    for (const Candidate& c : *list) gone.push_back({row(c.source), column(c.target)});
  }
  // A pair of this alignment can be in an earlier one's halo only when that took it out of the matrix; so `own` has all
  // its pairs, and the matrix shrinks.
  aligner_->remove(gone);
  state_.candidates_known += own.size() + halo.size();
  search.postponed.insert(search.postponed.end(), own.begin(), own.end());
  search.pending.insert(search.pending.end(), halo.begin(), halo.end());
}

}  // namespace mapweld
