// What the limit comes to as lines of a chart over verifications: the clairvoyant spends one for each edge.
#pragma once

#include <functional>
#include <vector>

#include "server/evaluation/chart.h"
#include "server/evaluation/limit.h"

namespace mapweld::server::evaluation {

ChartSeries clairvoyant_series(const Limit& limit, const std::function<double(const CurvePoint&)>& value);

// A thin line of the bound's shares of the final value.
ChartSeries bound_series(const Limit& limit, double final_connectivity);

std::vector<LegendEntry> legend_of_limit();

}  // namespace mapweld::server::evaluation
