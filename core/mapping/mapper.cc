#include "core/mapping/mapper.h"

namespace mapweld {

MappingDecision decide(const AppearanceVector& image, const MapView& map, const PairVerifier& verifier,
                       const MapParameters& parameters) {
  const Localization found = localize(image, map, verifier, parameters);
  MappingDecision decision;
  decision.reason = found.reason;
  for (const LocalizationMatch& match : found.matches) {
    if (!match.verified) break;
    decision.edges.push_back(match);
  }
  if (!decision.edges.empty() && decision.edges.front().verification.inliers > parameters.max_inliers) {
    decision.outcome = MappingDecision::Outcome::kIgnored;
    decision.similar_to = decision.edges.front().vertex;
    decision.inliers = decision.edges.front().verification.inliers;
    decision.edges.clear();
  }
  return decision;
}

}  // namespace mapweld
