// The anytime curve as a table for other programs.
#pragma once

#include <span>
#include <string>

#include "client/contract/merge.h"

namespace mapweld::drawing {

// One line of names and one a point, comma-separated, the fields of docs/http-api.md in their order; nested ones are
// flattened with an underscore, null is empty. Numbers read back as what they were.
std::string curve_csv(std::span<const contract::CurvePoint> points);

}  // namespace mapweld::drawing
