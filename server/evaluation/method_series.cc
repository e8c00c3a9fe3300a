#include "server/evaluation/method_series.h"

#include <algorithm>
#include <cmath>

namespace mapweld::server::evaluation {
namespace {

constexpr int kGrid = 120;

std::vector<double> grid(double least, double most) {
  std::vector<double> xs{0};
  for (int i = 0; i <= kGrid; ++i) {
    const double share = static_cast<double>(i) / kGrid;
    xs.push_back(most * share);
    if (least > 0 && most > least) xs.push_back(least * std::pow(most / least, share));
  }
  std::ranges::sort(xs);
  xs.erase(std::unique(xs.begin(), xs.end()), xs.end());
  return xs;
}

}  // namespace

CurvePoint interpolated(const std::vector<CurvePoint>& curve, std::uint64_t edges) {
  if (curve.empty()) return {};
  const auto after = std::ranges::lower_bound(curve, edges, {}, &CurvePoint::edges);
  if (after == curve.end()) return curve.back();
  if (after->edges == edges || after == curve.begin()) return *after;
  const CurvePoint& from = *(after - 1);
  const double share = static_cast<double>(edges - from.edges) / static_cast<double>(after->edges - from.edges);
  const auto between = [&](std::uint32_t a, std::uint32_t b) {
    return static_cast<std::uint32_t>(std::lround(a + (static_cast<double>(b) - a) * share));
  };
  return {edges, from.connectivity + (after->connectivity - from.connectivity) * share,
          between(from.joined_vertices, after->joined_vertices),
          between(from.independent_joins, after->independent_joins)};
}

ChartSeries method_series(const MethodResult& method, CostAxis axis, double modelled_verifier_s, double x_least,
                          const std::vector<std::uint64_t>& edges, const RunValue& value) {
  ChartSeries series;
  series.style = style_of_method(method.method);
  series.marks_end = true;
  const auto cost = [&](const Cost& spent) { return on_axis(spent, axis, modelled_verifier_s); };
  if (method.runs.size() == 1) {
    const RecordedRun& run = method.runs.front();
    for (const std::uint64_t count : edges) {
      series.points.push_back({cost(cost_of(run, count)), value(0, count)});
    }
    series.points.push_back({cost(run.cost), value(0, run.edges.size())});
    return series;
  }
  double most = 0;
  for (const RecordedRun& run : method.runs) most = std::max(most, cost(run.cost));
  for (const double x : grid(x_least, most)) {
    std::vector<double> values;
    for (std::size_t i = 0; i < method.runs.size(); ++i) {
      values.push_back(value(i, edges_within(method.runs[i], axis, modelled_verifier_s, x)));
    }
    const Summary summary = summary_of(values);
    series.points.push_back({x, summary.mean});
    series.spread.push_back(summary.deviation);
  }
  return series;
}

std::vector<LegendEntry> legend_of(const Evaluation& evaluation) {
  std::vector<LegendEntry> legend;
  for (const MethodResult& method : evaluation.methods) {
    std::string name = method.method;
    if (method.runs.size() > 1) name += " (mean \u00B1 sd, " + std::to_string(method.runs.size()) + " runs)";
    legend.push_back({name, style_of_method(method.method)});
  }
  return legend;
}

double least_on_axis(const Evaluation& evaluation, CostAxis axis) {
  double least = 0;
  for (const MethodResult& method : evaluation.methods) {
    for (const RecordedRun& run : method.runs) {
      if (run.edges.empty()) continue;
      const double first = on_axis(run.edges.front().cost, axis, evaluation.options.modelled_verifier_s);
      if (first > 0 && (least == 0 || first < least)) least = first;
    }
  }
  if (least == 0) return 1;
  const double power = std::pow(10, std::floor(std::log10(least) + 1e-9));
  for (const double lead : {5.0, 2.0}) {
    if (lead * power <= least * (1 + 1e-9)) return lead * power;
  }
  return power;
}

double most_on_axis(const Evaluation& evaluation, CostAxis axis) {
  double most = 0;
  for (const MethodResult& method : evaluation.methods) {
    for (const RecordedRun& run : method.runs) {
      most = std::max(most, on_axis(run.cost, axis, evaluation.options.modelled_verifier_s));
    }
  }
  return most > 0 ? most : 1;
}

}  // namespace mapweld::server::evaluation
