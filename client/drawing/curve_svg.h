// The anytime curve of a merge as a figure: the paper's figure 6.
#pragma once

#include <span>
#include <string>

#include "client/contract/merge.h"

namespace mapweld::drawing {

// An SVG document of panels over one time axis: the algebraic connectivity of the largest component (right: in per cent
// of the last value), the number of edges between the maps and, when it changes, the size of the largest component,
// whose growth is what makes the first one fall. Phases are bands in the background. A merge that is complete has a
// line where 90 % of the final connectivity is reached for good.
std::string curve_svg(const contract::Merge& merge, std::span<const contract::CurvePoint> points);

}  // namespace mapweld::drawing
