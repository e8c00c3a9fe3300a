// How much what is known about a verified edge speaks for its two images showing one place.
#pragma once

#include <cstdint>

namespace mapweld {

// What the guard measures of an edge (u, v) on the maps of its ends. All of it only grows while edges are added to a
// merge, or stands still.
struct EdgeSigns {
  // Inliers whose word and signature no far image of either own map holds. Far: no verified link to the end, and no
  // common verified neighbour.
  int rare_matches = 0;
  std::uint32_t far_images = 0;  // of the end whose map has fewer: how well rarity could be tested
  // Of the features of an image, those that a far image of its map holds, in [0, 1]: the greater of the two ends.
  double common_share = 0;
  double fullness = 0;  // see edge_fullness
  // The greatest of this edge's fullness and of that of edges that support it, as far as the links to these are full.
  double fullness_around = 0;
  // How fully the maps show a place again that they have seen from nearly the same spot, by the greatest fullness of an
  // inner edge of either end: of two maps the lesser (one may be far denser), of one map the geometric mean. 0 where an
  // end has no inner edge.
  double inner_fullness = 0;
  // Of an edge between successive images of one map: the log odds that it is one because they are neighbours on the way
  // (see way_odds). Counts for the verdict on this edge alone; belief in it is passed on without.
  double on_the_way = 0;
  friend bool operator==(const EdgeSigns&, const EdgeSigns&) = default;
};

// A logistic model, additive in log odds: each sign has its say, weighed by how well the maps at hand can test it.
// Fitted by guard_fit; docs/alias-guard.md says on which places, and shows others. A sign that the maps cannot test (no
// far image, no inner edge) adds nothing, and the absence of one that they cannot test takes nothing.
struct EvidenceModel {
  // Before anything is known: of an edge between maps, and inside a map, where most edges join successive views.
  double prior = -3.1;
  double inner_prior = -2.75;
  // For: rare matches, by the chance that a thing seen elsewhere would have been met, far / (far + half_tested), and by
  // how much the images are like others of their maps: self-similarity = (common_share + common_floor) / ln(1 + far),
  // as a multiple of what is usual. Where much of an image recurs, what has not yet recurred is worth less.
  double rarity = 2.8;
  double half_tested = 100;
  double common_floor = 0.1;
  double usual_similarity = 0.07;
  // For: a fullness around of more than `full`.
  double fullness = 4.2;
  double full = 1.3;
  // Against: less of it than the maps' own inner fullness, by how dense they are, inner^2 / (inner^2 + dense^2).
  double shortfall = 2.3;
  double dense = 1.5;
  // For, inside a map: an edge that is at least `near_view` as full as the fullest edges of its ends joins views from
  // nearly one spot, and where maps are dense these are neighbours on the way: nearness * density^4.
  double nearness = 4;
  double near_view = 0.6;
  // The most that is made of an edge between successive images.
  double most_on_the_way = 4;
  // What an edge whose ends are within one link of another's is worth less than that one.
  double step = 0.25;
};

// The parts of the log odds, in natural units.
struct EvidenceParts {
  double prior = 0;
  double rarity = 0;     // >= 0
  double fullness = 0;   // >= 0
  double shortfall = 0;  // <= 0
  double nearness = 0;   // >= 0, inside a map only
  double sum() const { return prior + rarity + fullness + shortfall + nearness; }
  friend bool operator==(const EvidenceParts&, const EvidenceParts&) = default;
};

// Whether an edge is as full as views from nearly one spot are on its maps.
bool is_near_view(const EdgeSigns& signs, const EvidenceModel& model);

// The same bits on every processor.
EvidenceParts weigh(const EdgeSigns& signs, const EvidenceModel& model, bool is_inner = false);

// 1 / (1 + e^-x), to four decimals, at most 0.9999: nothing is certain. The same on every processor, not decreasing in
// x.
double confidence_of(double log_odds);
// The least log odds with at least this confidence; `confidence` in [0, 1]. -infinity for 0, infinity for more than
// confidence_of can give.
double log_odds_of(double confidence);

}  // namespace mapweld
