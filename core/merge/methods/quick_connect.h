// QuickConnect (paper, section V, Algorithms 1 and 2).
#pragma once

#include <cstdint>
#include <queue>
#include <string_view>
#include <utility>
#include <vector>

#include "core/merge/methods/pair_merger.h"
#include "core/retrieval/word_voter.h"

namespace mapweld {

// As in the paper, with what it leaves open settled in docs/merging.md:
//
// Exploration. W holds the words of m2 that m1 has too, ordered by (priority descending, word ascending). A word's
// votes are added to S; the pairs that it takes to min_votes are the new candidates E, by (votes descending, source,
// target). A candidate is verified when no edge was inserted from its source yet; one that passes becomes an edge,
// marks its source processed and adds 1 to the priority of each word of that source which is still in W; one that fails
// leaves the source free. Candidates of a processed source are postponed to L.
//
// Refinement. When W is empty, L is sorted once: by the lower degree of the two ends (in the graph as it then is),
// final votes descending, source, target; and verified in that order.
//
// So every pair whose final votes reach min_votes is verified exactly once. S is dense up to kDenseCells cells; beyond,
// a voting phase finds the cells that can become candidates, image by image of m2, and only those are kept: the
// sequence of verdicts is the same.
class QuickConnect final : public PairMerger {
 public:
  static constexpr std::string_view kName = "quickconnect";
  static constexpr std::uint64_t kDenseCells = std::uint64_t{1}
                                               << 23;  // 16 MiB, written to a checkpoint in about 50 ms
  // A word with more pairs of images than this is voted for in several steps.
  static constexpr std::uint64_t kPairsPerStep = std::uint64_t{1} << 22;

  struct Limits {
    std::uint64_t dense_cells = kDenseCells;
    std::uint64_t pairs_per_step = kPairsPerStep;
  };
  explicit QuickConnect(MergeInput input) : QuickConnect(std::move(input), Limits{}) {}
  QuickConnect(MergeInput input, Limits limits);  // smaller limits make small tests reach every path

  void step() override;
  std::uint32_t words_total() const override { return static_cast<std::uint32_t>(votes().words().size()); }

 private:
  void resume(MergeState state) override;
  void upcoming(std::size_t most, std::vector<Candidate>& candidates) const override;
  void begin_pair();
  void keep_row();        // voting: one image of m2
  void vote();            // exploration: (a part of) one word
  void take_pending();    // exploration: one candidate of E
  void take_postponed();  // refinement: one candidate of L
  void advance_phase();
  void sort_postponed();
  void raise_words_of(std::uint32_t row);
  void rebuild_queue();

  struct QueuedWord {
    std::uint32_t priority;
    std::uint32_t word;
    // Of two words the one that is taken later; std::priority_queue keeps the greatest on top.
    bool operator<(const QueuedWord& other) const {
      return priority != other.priority ? priority < other.priority : word > other.word;
    }
  };
  Limits limits_;
  WordVoter voter_;
  // W's order, following from priorities and word_processed: entries that no longer agree with them are skipped.
  std::priority_queue<QueuedWord> queue_;
  std::vector<SimilarityMatrix::Cell> reached_;  // scratch
  std::vector<std::uint32_t> row_votes_;         // scratch
  std::vector<VotedVertex> word_votes_;          // scratch
};

}  // namespace mapweld
