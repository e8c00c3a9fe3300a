// What a method's runs come to as one line of a chart.
#pragma once

#include <functional>

#include "server/evaluation/chart.h"
#include "server/evaluation/evaluation.h"

namespace mapweld::server::evaluation {

// A quantity of a run after so many of its edges.
using RunValue = std::function<double(std::size_t run, std::uint64_t edges)>;

// One run: its own points, at the numbers of edges in `edges` (ascending), drawn from nothing to the end of the merge.
// Several: mean and standard deviation of all of them on a grid that is dense on a linear axis and on one that is
// logarithmic from `x_least` on.
ChartSeries method_series(const MethodResult& method, CostAxis axis, double modelled_verifier_s, double x_least,
                          const std::vector<std::uint64_t>& edges, const RunValue& value);

// A curve point between those that were computed: linear in the number of edges.
CurvePoint interpolated(const std::vector<CurvePoint>& curve, std::uint64_t edges);

std::vector<LegendEntry> legend_of(const Evaluation& evaluation);

// Where a logarithmic axis begins so that every method's first edge is on it: 1, 2 or 5 times a power of ten.
double least_on_axis(const Evaluation& evaluation, CostAxis axis);
// The greatest cost of a whole merge.
double most_on_axis(const Evaluation& evaluation, CostAxis axis);

}  // namespace mapweld::server::evaluation
