#include "server/evaluation/limit_series.h"

namespace mapweld::server::evaluation {
namespace {

const ChartStyle kClairvoyant{.colour = "#5A3FA0"};
const ChartStyle kBound{.colour = "#5A3FA0", .width_px = 0.9};

}  // namespace

ChartSeries clairvoyant_series(const Limit& limit, const std::function<double(const CurvePoint&)>& value) {
  ChartSeries series{.style = kClairvoyant, .marks_end = true};
  for (const CurvePoint& point : limit.clairvoyant) {
    series.points.push_back({static_cast<double>(point.edges), value(point)});
  }
  return series;
}

ChartSeries bound_series(const Limit& limit, double final_connectivity) {
  ChartSeries series{.style = kBound};
  for (const BoundPoint& point : limit.bound) {
    series.points.push_back({static_cast<double>(point.edges), point.connectivity / final_connectivity});
  }
  return series;
}

std::vector<LegendEntry> legend_of_limit() {
  return {{"clairvoyant (knows which candidates pass)", kClairvoyant}, {"bound of any order", kBound}};
}

}  // namespace mapweld::server::evaluation
