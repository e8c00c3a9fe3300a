#include "core/mapping/mapper.h"

#include <algorithm>
#include <utility>

#include "core/mapping/static_content.h"
#include "core/mapping/unmoved_view.h"

namespace mapweld {
namespace {

// The match of a vertex that has seen enough of the image already; null when there is none. `matches`: verified, by
// inliers.
const LocalizationMatch* find_too_similar(const AppearanceVector& image, const MapView& map,
                                          const std::vector<LocalizationMatch>& matches,
                                          const MapParameters& parameters) {
  if (matches.empty() || parameters.max_inliers >= kUnlimitedInliers) return nullptr;
  if (matches.front().verification.inliers > parameters.max_inliers) return &matches.front();
  const auto unmoved = std::ranges::find_if(matches, [&](const LocalizationMatch& match) {
    return is_unmoved_view(image, *map.appearances(match.vertex), match.verification);
  });
  return unmoved == matches.end() ? nullptr : &*unmoved;
}

// What becomes of an image whose static appearances are set apart.
MappingDecision decide_on(const AppearanceVector& image, const MapView& map, const PairVerifier& verifier,
                          const MapParameters& parameters) {
  const Localization found = localize(image, map, verifier, parameters);
  MappingDecision decision;
  decision.reason = found.reason;
  for (const LocalizationMatch& match : found.matches) {
    if (!match.verified) break;
    decision.edges.push_back(match);
  }
  if (const LocalizationMatch* similar = find_too_similar(image, map, decision.edges, parameters)) {
    decision.outcome = MappingDecision::Outcome::kIgnored;
    decision.similar_to = similar->vertex;
    decision.inliers = similar->verification.inliers;
    decision.edges.clear();
  }
  return decision;
}

}  // namespace

MappingDecision decide(const AppearanceVector& image, const MapView& map, const PairVerifier& verifier,
                       const MapParameters& parameters) {
  AppearanceVector split = with_known_static(image, map);
  MappingDecision decision = decide_on(split, map, verifier, parameters);
  if (decision.outcome == MappingDecision::Outcome::kIgnored) return decision;
  std::vector<VertexId> linked;
  for (const LocalizationMatch& edge : decision.edges) linked.push_back(edge.vertex);
  if (learn_static(split, linked, map)) decision = decide_on(split, map, verifier, parameters);
  if (decision.outcome == MappingDecision::Outcome::kInserted) decision.image = std::move(split);
  return decision;
}

}  // namespace mapweld
