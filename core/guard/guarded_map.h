// What the guard knows of one map: which of its edges are confirmed, and how well it can test what others show it.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/guard/evidence_model.h"
#include "core/guard/links.h"
#include "core/guard/own_rarity.h"
#include "core/guard/verdict.h"
#include "core/guard/verified_edge.h"
#include "core/merge/executor.h"

namespace mapweld {

// Follows from the map's images and verified edges alone, however these came; the order of the images counts as far as
// it shows in the edges (EdgeSigns::on_the_way). One thread.
class GuardedMap {
 public:
  // Images 0 .. vertices-1; `edges`: all verified ones between them, each once. What `images` throws passes through;
  // std::invalid_argument for an edge beyond the images or their appearances. With an executor part of the work is done
  // on its threads; the result is the same.
  GuardedMap(std::uint32_t vertices, const ImageLookup& images, std::span<const VerifiedEdge> edges,
             const GuardOptions& options, const Executor* executor = nullptr);

  // By edge, as given.
  const std::vector<GuardVerdict>& verdicts() const { return verdicts_; }
  // The images beside each image, by its fullest edges. Around: all verified ones, each with its fullness in the place
  // of a belief. Passing: those that are near views (is_near_view), which are taken for certain, and the confirmed ones
  // with what is believed of them.
  const LinkLists& around() const { return around_; }
  const LinkLists& passing() const { return passing_; }
  // The greatest fullness of a verified edge at a vertex; 0 without one.
  double fullness(std::uint32_t vertex) const { return fullness_[vertex]; }
  OwnRarity& rarity() { return rarity_; }

 private:
  std::vector<double> fullness_;
  LinkLists around_, passing_;
  std::vector<GuardVerdict> verdicts_;
  OwnRarity rarity_;
};

}  // namespace mapweld
