// How fully two images show one view.
#pragma once

#include "core/guard/verified_edge.h"
#include "core/types.h"

namespace mapweld {

// The root of the inliers, times the matched share, times the shared view (view_overlap): how much of a view is the
// same, all over. A view seen twice has 2 to 9, a poster or a piece of furniture in two places 0.1 to 2.
// std::invalid_argument for matches that are not of the images.
double edge_fullness(const AppearanceVector& u, const AppearanceVector& v, const VerifiedEdge& edge);

}  // namespace mapweld
