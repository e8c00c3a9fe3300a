#include "core/merge/methods/quick_connect.h"

#include <algorithm>
#include <stdexcept>
#include <unordered_set>
#include <utility>

#include "core/errors.h"

namespace mapweld {

QuickConnect::QuickConnect(MergeInput input, Limits limits)
    : PairMerger(std::move(input), CountsBeforehand::kAlways), limits_(limits), voter_(input_.options.votes) {
  begin_pair();
  advance_phase();
}

void QuickConnect::begin_pair() {
  PairSearch& search = state_.search;
  const std::uint32_t rows = votes().rows(), columns = votes().columns();
  const bool is_sparse = static_cast<std::uint64_t>(rows) * columns > limits_.dense_cells;
  search.similarity = is_sparse ? SimilarityMatrix::sparse(rows, columns) : SimilarityMatrix::dense(rows, columns);
  search.priorities.assign(votes().words().size(), 0);
  search.word_processed.assign(votes().words().size(), 0);
  search.source_processed.assign(rows, 0);
  state_.phase = is_sparse ? MergePhase::kVoting : MergePhase::kExploration;
  rebuild_queue();
}

void QuickConnect::resume(MergeState state) {
  select_pair(state.pair);
  begin_pair();
  const PairSearch& search = state.search;
  const SimilarityMatrix& fresh = state_.search.similarity;
  const std::size_t words = votes().words().size();
  bool fits = search.similarity.is_sparse() == fresh.is_sparse() && search.similarity.rows() == fresh.rows() &&
              search.similarity.columns() == fresh.columns() && search.priorities.size() == words &&
              search.word_processed.size() == words && search.source_processed.size() == votes().rows();
  fits = fits && search.words_processed == static_cast<std::size_t>(std::ranges::count(search.word_processed, 1));
  fits = fits && (search.word_in_hand == PairSearch::kNoWord ||
                  (search.word_in_hand < words &&
                   search.word_next_row < count_vertices(votes().row_postings(search.word_in_hand).vertices)));
  if (fresh.is_sparse()) {
    fits = fits && search.similarity.appended_rows() == search.next_row &&
           (state.phase == MergePhase::kVoting || search.next_row == votes().rows());
  }
  if (!fits) throw FormatError("a merge state whose queue or similarity matrix is not of its maps");
  PairMerger::resume(std::move(state));
  rebuild_queue();
}

void QuickConnect::step() {
  const PairSearch& search = state_.search;
  switch (state_.phase) {
    case MergePhase::kVoting:
      keep_row();
      break;
    case MergePhase::kExploration:
      if (search.pending_next < search.pending.size() && search.word_in_hand == PairSearch::kNoWord) {
        take_pending();
      } else {
        vote();
      }
      break;
    case MergePhase::kRefinement:
      take_postponed();
      break;
    case MergePhase::kVerification:
    case MergePhase::kDone:
      throw std::logic_error("a merge that is done has no next step");
  }
  ++state_.step;
  advance_phase();
}

void QuickConnect::keep_row() {
  PairSearch& search = state_.search;
  votes_of_row(votes(), search.next_row, input_.options.votes, row_votes_);
  std::vector<std::uint32_t> columns;
  for (std::uint32_t column = 0; column < row_votes_.size(); ++column) {
    if (row_votes_[column] >= input_.options.min_votes) columns.push_back(column);
  }
  search.similarity.append_row(columns);
  ++search.next_row;
}

void QuickConnect::vote() {
  PairSearch& search = state_.search;
  if (search.word_in_hand == PairSearch::kNoWord) {
    while (search.word_processed[queue_.top().word] || queue_.top().priority != search.priorities[queue_.top().word]) {
      queue_.pop();
    }
    search.word_in_hand = queue_.top().word;
    search.word_next_row = 0;
    queue_.pop();
    search.word_processed[search.word_in_hand] = 1;
    ++search.words_processed;
    search.pending.clear();
    search.pending_next = 0;
  }
  const PostingSpan rows = votes().row_postings(search.word_in_hand);
  const PostingSpan columns = votes().column_postings(search.word_in_hand);
  const std::uint64_t part = std::max<std::uint64_t>(1, limits_.pairs_per_step / count_vertices(columns.vertices));
  std::size_t from = 0;
  for (std::uint32_t r = 0; r < search.word_next_row; ++r) from = end_of_vertex(rows.vertices, from);
  reached_.clear();
  for (std::uint64_t n = 0; n < part && from < rows.size(); ++n) {
    const std::size_t to = end_of_vertex(rows.vertices, from);
    word_votes_.clear();
    voter_.vote(rows.signatures.subspan(from, to - from), columns, [this](VertexId column, std::uint32_t given) {
      word_votes_.push_back({column, given});
    });
    search.similarity.add(to_index(rows.vertices[from]), word_votes_, input_.options.min_votes, reached_);
    from = to;
    ++search.word_next_row;
  }
  for (const SimilarityMatrix::Cell& cell : reached_) {
    search.pending.push_back({source(cell.row), target(cell.column), cell.votes});
  }
  state_.candidates_known += reached_.size();
  if (from < rows.size()) return;
  search.word_in_hand = PairSearch::kNoWord;
  search.word_next_row = 0;
  std::ranges::sort(search.pending, [](const Candidate& a, const Candidate& b) {
    if (a.votes != b.votes) return a.votes > b.votes;
    return std::pair(a.source, a.target) < std::pair(b.source, b.target);
  });
}

void QuickConnect::take_pending() {
  PairSearch& search = state_.search;
  const Candidate candidate = search.pending[search.pending_next];
  const std::uint32_t from = row(candidate.source);
  if (search.source_processed[from]) {
    search.postponed.push_back(candidate);
  } else if (verify(candidate)) {
    search.source_processed[from] = 1;
    raise_words_of(from);
  }
  ++search.pending_next;
}

void QuickConnect::take_postponed() {
  PairSearch& search = state_.search;
  verify(search.postponed[search.postponed_next]);
  ++search.postponed_next;
}

void QuickConnect::advance_phase() {
  for (;;) {
    const PairSearch& search = state_.search;
    if (state_.phase == MergePhase::kVoting && search.next_row == votes().rows()) {
      state_.phase = MergePhase::kExploration;
    }
    if (state_.phase == MergePhase::kExploration && search.words_processed == search.word_processed.size() &&
        search.word_in_hand == PairSearch::kNoWord && search.pending_next == search.pending.size()) {
      sort_postponed();
      state_.phase = MergePhase::kRefinement;
    }
    if (state_.phase != MergePhase::kRefinement || search.postponed_next < search.postponed.size()) return;
    if (!next_pair()) {
      state_.phase = MergePhase::kDone;
      return;
    }
    begin_pair();
  }
}

void QuickConnect::upcoming(std::size_t most, std::vector<Candidate>& candidates) const {
  const PairSearch& search = state_.search;
  if (state_.phase == MergePhase::kRefinement) {
    for (std::size_t i = search.postponed_next; i < search.postponed.size() && candidates.size() < most; ++i) {
      candidates.push_back(search.postponed[i]);
    }
    return;
  }
  // Of one source only the first: when it passes, the others are postponed.
  std::unordered_set<VertexId> sources;
  for (std::size_t i = search.pending_next; i < search.pending.size() && candidates.size() < most; ++i) {
    const Candidate& c = search.pending[i];
    if (!search.source_processed[row(c.source)] && sources.insert(c.source).second) candidates.push_back(c);
  }
}

void QuickConnect::sort_postponed() {
  PairSearch& search = state_.search;
  // Ascending (degree, -votes), (source, target), each pair packed into one number: L may hold a million candidates,
  // and sorting it is one step.
  std::vector<std::pair<std::uint64_t, std::uint64_t>> keys;
  keys.reserve(search.postponed.size());
  for (const Candidate& c : search.postponed) {
    const std::uint64_t degree = std::min(graph_.degree(c.source), graph_.degree(c.target));
    const std::uint32_t votes = search.similarity.at(row(c.source), column(c.target));
    keys.emplace_back(degree << 32 | (0xFFFFFFFFu - votes),
                      std::uint64_t{to_index(c.source)} << 32 | to_index(c.target));
  }
  std::ranges::sort(keys);
  for (std::size_t i = 0; i < keys.size(); ++i) {
    const auto [order, ends] = keys[i];
    search.postponed[i] = {VertexId{static_cast<std::uint32_t>(ends >> 32)}, VertexId{static_cast<std::uint32_t>(ends)},
                           0xFFFFFFFFu - static_cast<std::uint32_t>(order)};
  }
}

void QuickConnect::raise_words_of(std::uint32_t row) {
  PairSearch& search = state_.search;
  for (const VoteSource::RowWord& w : votes().row_words(row)) {
    if (search.word_processed[w.word]) continue;
    queue_.push({++search.priorities[w.word], w.word});
  }
}

void QuickConnect::rebuild_queue() {
  const PairSearch& search = state_.search;
  std::vector<QueuedWord> words;
  for (std::uint32_t w = 0; w < search.priorities.size(); ++w) {
    if (!search.word_processed[w]) words.push_back({search.priorities[w], w});
  }
  queue_ = std::priority_queue<QueuedWord>(std::less<QueuedWord>(), std::move(words));
}

}  // namespace mapweld
