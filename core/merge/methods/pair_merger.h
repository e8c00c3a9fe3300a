// What the methods share that go from one pair of members to the next: whose votes are searched, and what becomes of a
// verdict.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <unordered_map>
#include <vector>

#include "core/merge/merger.h"
#include "core/merge/methods/verification_ahead.h"
#include "core/merge/vote_source.h"

namespace mapweld {

// Two members are one pair. Of more, all pairs are merged one after the other, that with the most candidates first
// (ties: in the order of the members); MergeState::pair says which one is in hand, and MergeState::search is about it.
// A method with one order over all pairs (CountsBeforehand::kNever) only votes that way, in the order of
// all_member_pairs; its states do not resume as those of a method that goes pair after pair.
class PairMerger : public Merger {
 public:
  std::optional<std::uint64_t> candidates_total() const override;
  std::optional<std::vector<Candidate>> open_candidates() const override;
  std::vector<bool> finished_pairs() const override;

 protected:
  // Whether all votes are counted once beforehand, so that candidates_total() is known from the start.
  enum class CountsBeforehand : std::uint8_t {
    kAlways,
    kForSeveralPairs,  // which finds their order
    kNever,            // all votes come first, and then one order over all pairs
  };
  PairMerger(MergeInput input, CountsBeforehand counts);
  void resume(MergeState state) override;

  const VoteSource& votes() const { return *votes_; }
  VertexId source(std::uint32_t row) const { return input_.members[pair_.m2].vertices[row]; }
  VertexId target(std::uint32_t column) const { return input_.members[pair_.m1].vertices[column]; }
  const std::vector<MemberPair>& pairs() const { return pairs_; }
  std::uint32_t member_of(VertexId vertex) const { return member_of_[to_index(vertex)]; }
  std::uint32_t row(VertexId source) const { return position_[to_index(source)]; }
  std::uint32_t column(VertexId target) const { return position_[to_index(target)]; }
  // Takes up the pair of members that a state to be resumed is at, with a fresh search. Throws FormatError for a number
  // that is none. PairMerger::resume does it too.
  void select_pair(std::uint32_t pair);
  // Goes on to the next pair of members, with a fresh search; false, and nothing changed, after the last.
  bool next_pair();

  // Voting, one image of m2: the cells of row `search.next_row` whose final votes reach min_votes are appended to the
  // sparse S with their final votes; returns how many.
  std::size_t vote_row();

  // The verdict on a candidate of the pair in hand, recorded: an edge with its final votes, or a rejection. True: an
  // edge. A pair whose verdict is known from before the maps grew is not verified again.
  bool verify(const Candidate& candidate);
  // The same for a candidate of any pair whose votes are final.
  bool verify_final(const Candidate& candidate);

  // Whether there is a verdict on this pair from before the maps grew.
  bool is_known(VertexId u, VertexId v) const { return known_.contains(pair_key(u, v)); }

  // The candidates of the pair in hand that are still to be verified, once all its votes are in; they may hold some
  // whose verdict is known from before the maps grew. By default: the rest of L.
  virtual std::vector<Candidate> candidates_left() const;

  // The candidates of the sparse S that have no verdict.
  std::vector<Candidate> cells_left() const;

  // The candidates that will be verified next if all goes as it is expected to, for VerificationAhead: appends up to
  // `most`. None by default: then every pair is verified when its turn comes.
  virtual void upcoming(std::size_t /*most*/, std::vector<Candidate>& /*candidates*/) const {}

 private:
  void open_pair();  // that of state_.pair
  bool record(const Candidate& candidate, const std::function<std::uint32_t()>& final_votes);

  std::vector<MemberPair> pairs_;             // in the order in which they are merged
  std::vector<std::uint64_t> candidates_of_;  // by pair, in that order; empty: not counted beforehand
  MemberPair pair_;                           // in hand
  std::shared_ptr<const VoteSource> votes_;
  std::optional<std::uint64_t> candidates_total_;
  std::vector<std::uint32_t> position_;            // of each merged vertex in its member
  std::vector<std::uint32_t> member_of_;           // of each merged vertex
  std::unordered_map<std::uint64_t, bool> known_;  // accepted? by pair_key: verdicts from before the maps grew
  VerificationAhead ahead_;
  std::vector<std::uint32_t> row_votes_, row_columns_, kept_votes_;  // scratch
};

}  // namespace mapweld
