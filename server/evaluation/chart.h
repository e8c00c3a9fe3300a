// Charts of a paper's kind: curves with bands, dots and bars, on axes that say what they measure. The look is that of
// the house's other figures (client/drawing/svg.h).
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace mapweld::server::evaluation {

struct ChartStyle {
  std::string colour = "#000000";
  std::string dashes = {};  // SVG stroke-dasharray; empty: solid
  double width_px = 2;      // of a line
};

struct ChartPoint {
  double x = 0;
  double y = 0;
};

struct ChartSeries {
  ChartStyle style = {};
  std::vector<ChartPoint> points = {};  // ascending by x for a line
  std::vector<double> spread = {};      // as many as points, or none: a band of y +- spread behind the line
  bool dots = false;                    // dots instead of a line
  bool marks_end = false;               // a dot where the line ends
};

// y begins at 0. A logarithmic x axis begins at `x_least`; what lies before it is cut off.
struct ChartPanel {
  std::string title = {};
  std::string x_title = {};
  std::string y_title = {};
  bool log_x = false;
  double x_least = 1;
  double x_most = 1;
  double y_most = 1;
  int y_ticks = 5;
  std::vector<double> guides = {};  // dashed horizontal lines
  std::vector<ChartSeries> series = {};
};

struct LegendEntry {
  std::string name;
  ChartStyle style;
};

struct Chart {
  std::string title;
  std::string subtitle;
  std::vector<LegendEntry> legend;
  std::vector<ChartPanel> panels;  // row by row
  int columns = 1;
  double panel_width_px = 380;
  double panel_height_px = 230;
};
std::string chart_svg(const Chart& chart);

struct Bar {
  ChartStyle style;
  double value = 0;
  double deviation = 0;  // half the length of the error bar; 0: none
  std::string label;     // over the bar
};
struct BarGroup {
  std::vector<std::string> name;  // lines under the group
  std::vector<Bar> bars;
};
struct BarChart {
  std::string title;
  std::string subtitle;
  std::vector<LegendEntry> legend;
  std::string y_title;
  double y_most = 1;
  std::vector<BarGroup> groups;
};
std::string bar_chart_svg(const BarChart& chart);

// A method's own colour and dashes, the same in every figure. Okabe & Ito's colours; QuickConnect is red, DegreeMin
// green and random blue, as in the paper.
ChartStyle style_of_method(std::string_view method);

}  // namespace mapweld::server::evaluation
