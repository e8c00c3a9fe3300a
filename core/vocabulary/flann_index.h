// The paper's engine: FLANN's approximate search (Muja & Lowe 2009) in a hierarchical k-means tree.
//
// Of FLANN's two engines for SIFT the tree is the one that can be repeated: its randomised kd-forest seeds itself from
// std::random_device at every build, and needs as long for the same recall (docs/vocabulary.md).
#pragma once

#include <memory>

#include "core/vocabulary/word_index.h"

namespace mapweld {

class FlannIndex final : public WordIndex {
 public:
  ~FlannIndex() override;

  void quantise(std::span<const std::uint8_t> descriptors, std::span<WordId> words) const override;
  std::string_view engine() const override { return "flann"; }
  std::vector<std::uint8_t> serialize() const override;

  // FLANN draws from std::rand, which is the process's: a build seeds it, and two builds at once wait for each other.
  static std::unique_ptr<WordIndex> build(std::span<const std::uint8_t> centroids, const WordIndexOptions& options);
  // FLANN reads its own archive, and trusts it: load only what this program wrote (foreign_vocabulary.h).
  static std::unique_ptr<WordIndex> load(std::span<const std::uint8_t> centroids, std::span<const std::uint8_t> bytes);

 private:
  struct Tree;
  FlannIndex(std::unique_ptr<Tree> tree, int checks);
  std::unique_ptr<Tree> tree_;
  int checks_;
};

}  // namespace mapweld
