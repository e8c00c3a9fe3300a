// A camera that stands still: two images of one view, with nothing moved between them.
//
// The paper ignores an image that has more than T_max inliers with a vertex. That is absolute: of a dim view with 130
// features no image ever has so many, and a robot that waits in the dark for a minute leaves sixty vertices of one
// place.
#pragma once

#include "core/types.h"

namespace mapweld {

// Measured on drives and on noise (docs/pictures.md): a camera at rest stays clearly on this side of all three, one
// that moves clearly beyond the second.
struct UnmovedViewOptions {
  double min_matched_share = 0.5;  // inliers, of the features of the image that has fewer
  // Of the displacements of the inliers, three quarters and nine tenths are at most so long. In pixels of an image of
  // up to a megapixel; in a larger one, which is shrunk before its features are found, in pixels of the shrunk one.
  double three_quarters_within_px = 0.75;
  double nine_tenths_within_px = 1.5;
};

// Whether a verified pair is one view that nothing moved in. `verification`: of (a, b), accepted. Not by displacement
// alone, which a camera's own text has as well: what matches has to be most of what there is to match. Nor by the share
// alone, which a slow robot on a sparse place has: as soon as it has moved it is somewhere else.
bool is_unmoved_view(const AppearanceVector& a, const AppearanceVector& b, const Verification& verification,
                     const UnmovedViewOptions& options = {});

}  // namespace mapweld
