// DegreeMin (paper, section VI): randomised brute force that prefers images with few edges.
#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

#include "core/merge/methods/pair_merger.h"

namespace mapweld {

// An attempt draws an image of m2 with a mass inversely proportional to its degree in the merged graph as it then is
// (an image without an edge counts as one with one edge), and uniformly one of the images of m1 that it has not been
// drawn with yet. A pair with too few votes costs a look-up in S, any other its verification. First all votes are
// counted (kVoting, a step an image of m2); then a step draws until a candidate comes, but no more than kDrawsPerStep
// times. Verified one by one: what is drawn next depends on the verdict.
class DegreeMin final : public PairMerger {
 public:
  static constexpr std::string_view kName = "degree-min";
  static constexpr std::uint64_t kDrawsPerStep = 4096;
  static constexpr std::uint64_t kUnitMass = std::uint64_t{1} << 24;  // of degree 1; integers, so that nothing rounds
  explicit DegreeMin(MergeInput input);
  void step() override;

 private:
  void resume(MergeState state) override;
  std::vector<Candidate> candidates_left() const override { return cells_left(); }
  void begin_pair();
  void begin_drawing();
  void draw_until_candidate();
  void set_mass(std::uint32_t row);
  std::uint64_t mass_of(std::uint32_t row) const;
  void advance();

  // The masses of m2's images as a binary indexed tree (Fenwick 1994); follows from the graph and `drawn`.
  class Masses {
   public:
    void reset(std::size_t size);
    void set(std::uint32_t row, std::uint64_t mass);
    std::uint64_t total() const { return total_; }
    // The row whose mass covers the point, 0 <= point < total().
    std::uint32_t row_at(std::uint64_t point) const;

   private:
    std::vector<std::uint64_t> mass_, tree_;
    std::uint64_t total_ = 0;
  };
  Masses masses_;
};

}  // namespace mapweld
