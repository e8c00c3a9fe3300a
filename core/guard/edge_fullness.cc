#include "core/guard/edge_fullness.h"

#include <cmath>

#include "core/geometry/view_overlap.h"

namespace mapweld {

double edge_fullness(const AppearanceVector& u, const AppearanceVector& v, const VerifiedEdge& edge) {
  const ViewOverlap overlap = view_overlap(u, v, edge.inlier_matches);
  return std::sqrt(static_cast<double>(edge.inlier_matches.size())) * overlap.matched_share * overlap.shared_view;
}

}  // namespace mapweld
