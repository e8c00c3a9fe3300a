// The anytime curve as a figure and as a table.
#include <sstream>

#include <gtest/gtest.h>

#include "client/drawing/axis.h"
#include "client/drawing/curve_csv.h"
#include "client/drawing/curve_svg.h"
#include "client/drawing/svg.h"
#include "tests/client/drawing/well_formed.h"

namespace mapweld::drawing {
namespace {

using contract::CurvePoint;
using mapweld::testing::count_elements;
using mapweld::testing::element_of_class;
using mapweld::testing::xml_fault;

contract::Merge merge_in(const std::string& state) {
  contract::Merge merge;
  merge.id = 1;
  merge.state = state;
  merge.method = "quickconnect";
  merge.maps = {"lab-a", "lab-b"};
  merge.map = "lab";
  return merge;
}

// Connectivity 0, 1, .. 10 (times 0.001) at 0, 1, .. 10 s; exploration until 3 s.
std::vector<CurvePoint> ramp() {
  std::vector<CurvePoint> points;
  for (int i = 0; i <= 10; ++i) {
    CurvePoint point;
    point.step = 100 * i;
    point.elapsed_s = i;
    point.verifications = 7 * i;
    point.edges = 3 * i;
    point.components = 11 - i;
    point.largest_component = {100, 0.001 * i};
    point.phase = i < 3 ? "exploration" : "refinement";
    points.push_back(point);
  }
  return points;
}

TEST(CurveSvg, HasAPanelForConnectivityAndOneForEdges) {
  const std::string svg = curve_svg(merge_in("completed"), ramp());
  EXPECT_EQ(xml_fault(svg), "");
  EXPECT_EQ(count_elements(svg, "path"), 2U);
  EXPECT_NE(svg.find(">exploration<"), std::string::npos);
  EXPECT_NE(svg.find(">refinement<"), std::string::npos);
  EXPECT_NE(svg.find(">time of the merge (s)<"), std::string::npos);
  EXPECT_NE(svg.find(">90 % after 9 s, 90 % of the time<"), std::string::npos);
}

TEST(CurveSvg, ShowsTheLargestComponentWhenItGrows) {
  auto points = ramp();
  points[0].largest_component.vertices = 60;
  EXPECT_EQ(count_elements(curve_svg(merge_in("running"), points), "path"), 4U);
}

TEST(CurveSvg, PromisesNoFinalValueBeforeTheMergeIsComplete) {
  const std::string svg = curve_svg(merge_in("budget_exhausted"), ramp());
  EXPECT_EQ(svg.find("90 % after"), std::string::npos);
  EXPECT_NE(svg.find(">of the last value<"), std::string::npos);
}

TEST(CurveSvg, ReachesNinetyPerCentForGoodNotForAMoment) {
  auto points = ramp();
  points[2].largest_component.algebraic_connectivity = 0.01;
  EXPECT_NE(curve_svg(merge_in("completed"), points).find(">90 % after 9 s"), std::string::npos);
}

TEST(CurveSvg, DoesNotMistakeASmallComponentForAGoodMerge) {
  auto points = ramp();
  for (std::size_t i = 0; i < 5; ++i) points[i].largest_component = {60, 0.02};
  for (std::size_t i = 5; i < 11; ++i) points[i].largest_component = {100, 0.01};
  const std::string svg = curve_svg(merge_in("completed"), points);
  EXPECT_NE(svg.find(">90 % after 5 s"), std::string::npos);
  EXPECT_EQ(count_elements(svg, "path"), 4U);  // connectivity dotted and drawn, edges, size
}

TEST(CurveSvg, TakesNoPointsOnePointAndZeros) {
  EXPECT_EQ(xml_fault(curve_svg(merge_in("queued"), {})), "");
  const std::vector<CurvePoint> one(1);
  EXPECT_EQ(xml_fault(curve_svg(merge_in("running"), one)), "");
  std::vector<CurvePoint> many(500);
  for (std::size_t i = 0; i < many.size(); ++i) many[i].elapsed_s = 1e-6 * static_cast<double>(i);
  EXPECT_EQ(xml_fault(curve_svg(merge_in("running"), many)), "");
}

TEST(CurveSvg, TellsConfirmedFromVerifiedEdges) {
  auto points = ramp();
  const std::string plain = curve_svg(merge_in("completed"), points);
  for (auto& point : points) point.edge_counts = {.verified = point.edges, .confirmed = point.edges};
  const std::string all = curve_svg(merge_in("completed"), points);
  EXPECT_EQ(count_elements(all, "path"), count_elements(plain, "path"));  // one line says both
  for (auto& point : points) point.edge_counts = {.verified = point.edges, .confirmed = point.edges / 2};
  const std::string some = curve_svg(merge_in("completed"), points);
  EXPECT_EQ(xml_fault(some), "");
  EXPECT_EQ(count_elements(some, "path"), count_elements(plain, "path") + 1);
  EXPECT_NE(some.find("30 verified edges between the maps, 15 of them confirmed"), std::string::npos) << some;
}

TEST(CurveCsv, HasALineAPoint) {
  auto points = ramp();
  points[1].certified_fraction = 0.25;
  points[1].elapsed_s = 0.1;
  points[1].edge_counts = {.verified = 3, .confirmed = 2};
  std::istringstream csv(curve_csv(points));
  std::string line;
  std::getline(csv, line);
  EXPECT_EQ(line,
            "step,elapsed_s,verifications,edges,components,algebraic_connectivity,largest_component_vertices,"
            "largest_component_algebraic_connectivity,certified_fraction,phase,confirmed_edges");
  std::getline(csv, line);
  EXPECT_EQ(line, "0,0.0,0,0,11,0.0,100,0.0,,exploration,");
  std::getline(csv, line);
  EXPECT_EQ(line, "100,0.1,7,3,10,0.0,100,0.001,0.25,exploration,2");
  std::size_t rest = 0;
  while (std::getline(csv, line)) ++rest;
  EXPECT_EQ(rest, 9U);
}

TEST(AxisTicks, AreRoundAndCoverTheData) {
  for (const double most : {0.0, 1e-9, 0.0131, 0.1, 1.0, 9.99, 247.0, 2000.0, 123456.0}) {
    const Axis axis(most, 5, 0, 100);
    EXPECT_GE(axis.end(), most);
    EXPECT_GE(axis.ticks().size(), 2U);
    EXPECT_LE(axis.ticks().size(), 12U);
    EXPECT_DOUBLE_EQ(axis.at(axis.end()), 100);
  }
  const Axis axis(0.0131, 5, 0, 100);
  EXPECT_EQ(axis.label(axis.ticks()[1]), "0.005");
  EXPECT_EQ(Axis(247, 4, 0, 1).label(100), "100");
  const Axis tight(0.41, 8, 0, 100, Axis::End::kLast);
  EXPECT_DOUBLE_EQ(tight.at(0.41), 100);
  EXPECT_DOUBLE_EQ(tight.ticks().back(), 0.4);
}

TEST(SvgNumbers, AreShort) {
  EXPECT_EQ(px(12.50), "12.5");
  EXPECT_EQ(px(-0.001), "0");
  EXPECT_EQ(px(100), "100");
}

}  // namespace
}  // namespace mapweld::drawing
