// Merging by sequence alignment, after Ho & Newman (paper, reference [10]).
#pragma once

#include <cstdint>
#include <memory>
#include <string_view>
#include <vector>

#include "core/merge/methods/pair_merger.h"
#include "core/merge/methods/sequence_alignment.h"

namespace mapweld {

// The whole similarity matrix first, then local alignments of the two image sequences in both directions of travel,
// then verification along them. docs/alignment.md says where it follows Ho & Newman and where not.
//
// Voting. Row by row of S the cells whose final votes reach min_votes are kept. From each is taken what is usual: the
// level of a cell is the higher one of its row's and its column's level, that is of their vote at its level rank (the
// cells that are not kept count as min_votes - 1, so a level is never less). Cells above their level score
//   min(kMostScore, kLevelScore * (votes - level) / level), rounded down,
// so that no single cell makes an alignment, however alike its images are. Then SequenceAligner's alignments are taken
// one by one, best first. One that covers at least `min_images` images of either map is accepted: its cells are
// candidates, and with them the kept cells at most `halo` images from one of them in both sequences; all are taken out
// of the matrix. Of one that is not accepted only its own cells are taken out.
//
// Verification. The cells of the accepted alignments, best alignment first, along each in spread_order; then their
// halos, alignment by alignment, by (votes descending, source, target).
//
// So the candidates are a subset of all pairs whose final votes reach min_votes, each verified once, and the edges are
// a subset of brute force's. A step is the votes of one image of m2, a share of the dynamic programme, one alignment,
// or one verification.
class Alignment final : public PairMerger {
 public:
  static constexpr std::string_view kName = "alignment";
  static constexpr std::int32_t kLevelScore = 8;  // of a cell with twice the votes of its level
  static constexpr std::int32_t kMostScore = 8;

  // Defaults measured, see docs/alignment.md.
  struct Limits {
    SequenceAlignmentOptions sequence;
    std::uint32_t level_percent = 75;        // level_rank: so many of a row's (column's) cells are not above the level
    std::uint32_t min_images = 3;            // of each map, that an accepted alignment covers
    std::uint32_t halo = 2;                  // images round an alignment's cells
    std::uint32_t pairs_per_step = 1 << 15;  // of the dynamic programme
  };
  explicit Alignment(MergeInput input) : Alignment(std::move(input), Limits{}) {}
  Alignment(MergeInput input, const Limits& limits);  // smaller limits make small tests reach every path

  void step() override;
  // Nothing before the alignments of the last pair of members have been found.
  std::optional<std::uint64_t> candidates_total() const override;

 private:
  void resume(MergeState state) override;
  void upcoming(std::size_t most, std::vector<Candidate>& candidates) const override;
  void begin_pair();
  void advance();
  bool align();      // voting: one transition after the last row; false: there is nothing more to align
  bool take_next();  // one alignment
  void start_verification();

  std::vector<ScoredPair> score_cells() const;
  bool covers_enough(const SequenceAlignment& alignment) const;
  void accept(const SequenceAlignment& alignment);

  Limits limits_;
  // While alignments are sought; they follow from S and the number of transitions made.
  std::unique_ptr<SequenceAligner> aligner_;
  bool is_prepared_ = false;
  std::vector<bool> is_taken_;  // by kept cell: it is a candidate
};

}  // namespace mapweld
