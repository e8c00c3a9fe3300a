#include "core/merge/methods/pair_merger.h"

#include <algorithm>
#include <bit>
#include <functional>
#include <stdexcept>
#include <string_view>
#include <unordered_set>
#include <utility>

#include "core/errors.h"
#include "core/fingerprint.h"

namespace mapweld {
namespace {

// What a verdict depends on, apart from the pair.
std::uint64_t fingerprint_of_rules(const MergeInput& input) {
  Fingerprint hash;
  hash.add(std::string_view(input.options.method));
  hash.add(input.options.min_votes);
  hash.add(static_cast<std::uint64_t>(input.options.votes));
  hash.add(input.options.seed);
  hash.add(std::string_view(input.verifier->version()));
  hash.add(static_cast<std::uint64_t>(input.verifier->options().min_inliers));
  hash.add(std::bit_cast<std::uint64_t>(input.verifier->options().max_false_alarms));
  return hash.value();
}

void add_members(const std::vector<MergeMember>& members, Fingerprint& hash) {
  for (const MergeMember& member : members) {
    hash.add(member.vertices.size());
    for (const VertexId v : member.vertices) hash.add(to_index(v));
  }
}

std::shared_ptr<const VoteSource> votes_of(const MergeInput& input, const MemberPair& pair) {
  if (input.votes && input.members.size() == 2) return input.votes;
  return std::make_shared<WordVotes>(*input.appearances, input.members[pair.m1], input.members[pair.m2]);
}

}  // namespace

PairMerger::PairMerger(MergeInput input, CountsBeforehand counts)
    : Merger(std::move(input)), pairs_(all_member_pairs(input_.members)), ahead_(input_) {
  position_.resize(graph_.vertices());
  member_of_.resize(graph_.vertices());
  for (std::uint32_t k = 0; k < input_.members.size(); ++k) {
    const std::vector<VertexId>& vertices = input_.members[k].vertices;
    for (std::uint32_t i = 0; i < vertices.size(); ++i) {
      position_[to_index(vertices[i])] = i;
      member_of_[to_index(vertices[i])] = k;
    }
  }

  Fingerprint hash;
  add_members(input_.members, hash);
  const bool is_one_pair = pairs_.size() == 1;
  const bool counts_candidates =
      counts == CountsBeforehand::kAlways || (counts == CountsBeforehand::kForSeveralPairs && !is_one_pair);
  std::vector<std::pair<std::uint64_t, MemberPair>> promises;
  std::uint64_t total = 0;
  for (const MemberPair& pair : pairs_) {
    std::shared_ptr<const VoteSource> votes = votes_of(input_, pair);
    hash.add(votes->fingerprint(input_.options.votes));
    std::uint64_t candidates = 0;
    if (counts_candidates) {
      candidates = count_candidates(*votes, input_.options.votes, input_.options.min_votes);
    }
    total += candidates;
    promises.emplace_back(candidates, pair);
    if (is_one_pair) votes_ = std::move(votes);
  }
  std::ranges::stable_sort(promises, std::ranges::greater{}, &std::pair<std::uint64_t, MemberPair>::first);
  for (std::size_t k = 0; k < pairs_.size(); ++k) pairs_[k] = promises[k].second;
  if (counts_candidates) {
    candidates_total_ = total;
    for (const auto& [candidates, pair] : promises) candidates_of_.push_back(candidates);
  }

  state_.method = input_.options.method;
  state_.rules_fingerprint = fingerprint_of_rules(input_);
  if (counts == CountsBeforehand::kNever && !is_one_pair) {
    former_fingerprint_ = hash.value();
    hash.add(std::string_view("one order"));
  }
  state_.input_fingerprint = hash.value();
  state_.random = input_.options.seed;
  open_pair();
}

std::optional<std::uint64_t> PairMerger::candidates_total() const {
  // Without a count beforehand all votes come first.
  if (!candidates_total_ && state_.phase != MergePhase::kVoting) return state_.candidates_known;
  return candidates_total_;
}

std::optional<std::vector<Candidate>> PairMerger::open_candidates() const {
  if (done()) return std::vector<Candidate>{};
  const bool is_counting = state_.phase == MergePhase::kVoting || state_.phase == MergePhase::kExploration;
  if (is_counting || state_.pair + 1 < pairs_.size()) return std::nullopt;
  std::vector<Candidate> left = candidates_left();
  if (!known_.empty()) {
    std::erase_if(left, [this](const Candidate& c) { return known_.contains(pair_key(c.source, c.target)); });
  }
  return left;
}

std::vector<bool> PairMerger::finished_pairs() const {
  const std::size_t members = input_.members.size();
  std::vector<std::uint64_t> verdicts(pairs_.size(), 0);
  const auto is_absent = [this](VertexId v) { return std::ranges::binary_search(input_.absent, v); };
  const auto count = [&](VertexId u, VertexId v) {
    if (is_absent(u) || is_absent(v)) return;
    ++verdicts[place_of_pair(member_of_[to_index(u)], member_of_[to_index(v)], members)];
  };
  for (const MergeEdge& e : state_.edges) count(e.u, e.v);
  for (const RejectedPair& r : state_.rejected) count(r.source, r.target);
  std::vector<bool> finished(pairs_.size());
  for (std::size_t k = 0; k < pairs_.size(); ++k) {
    const std::size_t place = place_of_pair(pairs_[k].m1, pairs_[k].m2, members);
    const bool has_all = !candidates_of_.empty() && verdicts[place] >= candidates_of_[k];
    finished[place] = done() || k < state_.pair || has_all;
  }
  return finished;
}

std::vector<Candidate> PairMerger::candidates_left() const {
  const PairSearch& search = state_.search;
  return {search.postponed.begin() + static_cast<std::ptrdiff_t>(search.postponed_next), search.postponed.end()};
}

std::vector<Candidate> PairMerger::cells_left() const {
  std::unordered_set<std::uint64_t> verified;
  for (const MergeEdge& e : state_.edges) verified.insert(pair_key(e.u, e.v));
  for (const RejectedPair& r : state_.rejected) verified.insert(pair_key(r.source, r.target));
  std::vector<Candidate> left;
  const SimilarityMatrix& s = state_.search.similarity;
  for (std::uint32_t row = 0; row < s.appended_rows(); ++row) {
    for (std::uint64_t k = s.offsets()[row]; k < s.offsets()[row + 1]; ++k) {
      const Candidate candidate{source(row), target(s.kept_columns()[k]), s.votes()[k]};
      if (!verified.contains(pair_key(candidate.source, candidate.target))) left.push_back(candidate);
    }
  }
  return left;
}

void PairMerger::open_pair() {
  pair_ = pairs_.at(state_.pair);
  if (pairs_.size() > 1 || !votes_) votes_ = votes_of(input_, pair_);
}

void PairMerger::select_pair(std::uint32_t pair) {
  if (pair >= pairs_.size()) throw FormatError("a merge state about a pair of members that there is not");
  if (pair == state_.pair) return;
  state_.pair = pair;
  state_.search = {};
  open_pair();
}

bool PairMerger::next_pair() {
  if (state_.pair + 1 >= pairs_.size()) return false;
  select_pair(state_.pair + 1);
  return true;
}

std::size_t PairMerger::vote_row() {
  PairSearch& search = state_.search;
  votes_of_row(votes(), search.next_row, input_.options.votes, row_votes_);
  row_columns_.clear();
  kept_votes_.clear();
  for (std::uint32_t column = 0; column < row_votes_.size(); ++column) {
    if (row_votes_[column] < input_.options.min_votes) continue;
    row_columns_.push_back(column);
    kept_votes_.push_back(row_votes_[column]);
  }
  search.similarity.append_row(row_columns_, kept_votes_);
  ++search.next_row;
  return row_columns_.size();
}

void PairMerger::resume(MergeState state) {
  select_pair(state.pair);
  const auto fits = [this](VertexId source, VertexId target) {
    const std::size_t n = member_of_.size();
    return to_index(source) < n && to_index(target) < n && member_of_[to_index(source)] != member_of_[to_index(target)];
  };
  const PairSearch& search = state.search;
  bool good = search.pending_next <= search.pending.size() && search.postponed_next <= search.postponed.size() &&
              search.next_row <= votes().rows() && state.inherited_edges <= state.edges.size() &&
              state.inherited_rejected <= state.rejected.size();
  for (const auto* list : {&search.pending, &search.postponed}) {
    for (const Candidate& c : *list) good = good && fits(c.source, c.target);
  }
  for (const RejectedPair& r : state.rejected) good = good && fits(r.source, r.target);
  if (!good) throw FormatError("a merge state with candidates that its maps cannot have");
  for (std::uint64_t i = 0; i < state.inherited_edges; ++i) {
    known_.emplace(pair_key(state.edges[i].u, state.edges[i].v), true);
  }
  for (std::uint64_t i = 0; i < state.inherited_rejected; ++i) {
    known_.emplace(pair_key(state.rejected[i].source, state.rejected[i].target), false);
  }
  Merger::resume(std::move(state));
}

bool PairMerger::verify(const Candidate& candidate) {
  return record(candidate, [&] {
    return votes_of_pair(votes(), row(candidate.source), column(candidate.target), input_.options.votes);
  });
}

bool PairMerger::verify_final(const Candidate& candidate) {
  return record(candidate, [&] { return candidate.votes; });
}

bool PairMerger::record(const Candidate& candidate, const std::function<std::uint32_t()>& final_votes) {
  const VertexId u = std::min(candidate.source, candidate.target), v = std::max(candidate.source, candidate.target);
  if (const auto known = known_.find(pair_key(u, v)); known != known_.end()) return known->second;
  Verification verdict = ahead_.take(u, v, [this](std::size_t most, std::vector<Candidate>& candidates) {
    if (known_.empty()) {
      upcoming(most, candidates);
      return;
    }
    std::vector<Candidate> all;
    upcoming(most, all);
    for (const Candidate& c : all) {
      if (!known_.contains(pair_key(c.source, c.target))) candidates.push_back(c);
    }
  });
  ++state_.verifications;
  if (!verdict.accepted) {
    const auto short_count = [](int count) { return static_cast<std::uint16_t>(std::clamp(count, 0, 65535)); };
    state_.rejected.push_back({candidate.source, candidate.target, verdict.reason, short_count(verdict.matches),
                               short_count(verdict.inliers), candidate.votes});
    return false;
  }
  graph_.add_edge(u, v, static_cast<std::uint32_t>(verdict.inliers));
  state_.edges.push_back({u, v, final_votes(), std::move(verdict), state_.verifications});
  return true;
}

}  // namespace mapweld
