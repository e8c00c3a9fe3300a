// What verified edges say about each other: the belief in each, as they arrive.
#pragma once

#include <cstdint>
#include <vector>

#include "core/guard/evidence_model.h"
#include "core/guard/links.h"

namespace mapweld {

// Edges between the vertices of two sets (of two members, or of one map with itself). (u, v) and (x, y) support each
// other when x is u or a link of u, and y is v or a link of v.
//
// The belief in an edge is the greatest of the log odds of its own signs, and of what each edge that supports it passes
// on: the belief in that edge, at most that in the links that it is passed along, less EvidenceModel::step. A chain is
// as strong as its weakest link: one doubtful link inside a map leads no belief into its double. The solution is
// unique, so it depends on the set of edges alone; and it only grows as edges do. Costs a look at the supporters of
// what has changed. One thread.
class Beliefs {
 public:
  // Fullness is looked for `around` an edge along one set of links, whose beliefs are fullnesses: what is seen along a
  // link counts at most as full as the link; these do not change. Belief is passed on along another, which may change
  // between calls of `settle`. Both by vertex, may be one, must outlive this object.
  Beliefs(const LinkLists& around, const LinkLists& passing, const EvidenceModel& model, bool is_inner)
      : around_(around),
        passing_(passing),
        model_(model),
        is_inner_(is_inner),
        at_(around.size()),
        mark_(around.size(), 0),
        along_(around.size(), 0) {}

  // `signs.fullness_around` counts from the edge's own fullness on. Edges are numbered from 0.
  void add(std::uint32_t u, std::uint32_t v, const EdgeSigns& signs);
  // Takes up what has been added; with `links_changed`, of those that belief is passed on along, all edges again. No
  // belief is taken back.
  void settle(bool links_changed = false);

  std::uint32_t size() const { return static_cast<std::uint32_t>(edges_.size()); }
  // As of the last `settle`.
  const EdgeSigns& signs(std::uint32_t edge) const { return edges_[edge].signs; }
  double belief(std::uint32_t edge) const { return edges_[edge].belief; }

 private:
  struct Judged {
    std::uint32_t u = 0;
    std::uint32_t v = 0;
    EdgeSigns signs;
    double belief = 0;
  };
  // Calls use(f, belief) for each other edge f that supports edge e along `links`, once or more often, with the belief
  // in the weaker link.
  template <typename Use>
  void for_each_supporter(const LinkLists& links, std::uint32_t e, const Use& use);
  void see_around(std::uint32_t e, std::vector<std::uint32_t>& raised);

  const LinkLists& around_;
  const LinkLists& passing_;
  EvidenceModel model_;
  bool is_inner_;
  std::vector<Judged> edges_;
  std::vector<std::vector<std::uint32_t>> at_;  // edges by end
  std::uint32_t settled_ = 0;                   // so many edges have been taken up
  std::vector<std::uint32_t> mark_;             // scratch: stamp of the edge in hand, beside one of its ends
  std::vector<double> along_;                   // scratch: belief in the link to there
  std::uint32_t stamp_ = 0;
};

}  // namespace mapweld
