// Which features of an image its own map has nowhere else.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "core/guard/verified_edge.h"
#include "core/merge/executor.h"
#include "core/types.h"

namespace mapweld {

using ImageLookup = std::function<std::shared_ptr<const AppearanceVector>(std::uint32_t vertex)>;

// Features are the same when they have one word and signatures at most 32 bits apart (Hamming embedding, Jegou, Douze &
// Schmid 2008); without signatures, one word. Fixed once made, apart from what it remembers: one thread.
class OwnRarity {
 public:
  // `neighbours[v]`: the vertices that verify v, ascending. Reads every image once; what `images` throws passes
  // through. Memory: eight bytes an appearance, beside the images.
  OwnRarity(ImageLookup images, std::vector<std::vector<std::uint32_t>> neighbours);

  // Finds out about the vertices that links verify, as the other functions do about one when it is first asked for. In
  // pieces; those of a null executor one by one.
  void learn_linked(const Executor* executor);

  // Images of the map that are far from v: not v, no verified link to it, no common neighbour.
  std::uint32_t far_images(std::uint32_t vertex);
  // The share of v's features that a far image holds, in [0, 1]; 0 without features.
  double common_share(std::uint32_t vertex);
  // By appearance of v: whether no far image holds it. Valid as long as this object.
  const std::vector<bool>& rare(std::uint32_t vertex);
  // Inliers of an edge from `u` here to `v` of another map (or of this one) that are rare at both ends.
  // std::invalid_argument for matches that are not of the images.
  int rare_matches(std::uint32_t u, OwnRarity& other, std::uint32_t v, const VerifiedEdge& edge);

 private:
  struct Holder {
    std::uint32_t vertex = 0;
    std::uint16_t appearance = 0;
  };
  struct Known {
    bool is_known = false;
    std::uint32_t far_images = 0;
    double common_share = 0;
    std::vector<bool> rare;
  };
  // Of each vertex the last one that it was found near to, and one more; 0 for none.
  using NearTo = std::vector<std::uint32_t>;
  void learn(std::uint32_t vertex, NearTo& near);
  void learn(std::uint32_t vertex) { learn(vertex, near_); }

  std::vector<std::vector<std::uint32_t>> neighbours_;
  std::vector<std::shared_ptr<const AppearanceVector>> images_;
  std::vector<WordId> words_;           // of the map, ascending
  std::vector<std::uint32_t> offsets_;  // into holders_, by word
  std::vector<Holder> holders_;
  std::vector<Known> known_;
  NearTo near_;  // scratch
};

}  // namespace mapweld
