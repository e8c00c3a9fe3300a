// Mapping (paper, section III-B): a new image becomes a vertex with an edge to every verified similar image, or is
// ignored because the map has seen enough of it.
#pragma once

#include <vector>

#include "core/mapping/localizer.h"

namespace mapweld {

struct MappingDecision {
  enum class Outcome : std::uint8_t { kInserted, kIgnored } outcome = Outcome::kInserted;
  VertexId similar_to{};                 // kIgnored: the vertex that it resembles too much
  int inliers = 0;                       // kIgnored: to that vertex
  Reason reason = Reason::kNone;         // kInserted without an edge: why
  std::vector<LocalizationMatch> edges;  // kInserted: the verified matches of what counts of the image, by inliers
  AppearanceVector image;                // kInserted: with what is static set apart
};

// Decides what becomes of `image`; changes nothing. What the map knows to be static is set apart, and what the image
// adds to that (core/mapping/static_content.h); what follows is about the rest. It is ignored when it has more than
// max_inliers inliers with a vertex, or when it is the view of a vertex with nothing moved
// (core/mapping/unmoved_view.h). The first image of a map is always inserted, as is one without features.
MappingDecision decide(const AppearanceVector& image, const MapView& map, const PairVerifier& verifier,
                       const MapParameters& parameters);

}  // namespace mapweld
