#include "server/evaluation/chart.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

#include "client/drawing/axis.h"
#include "client/drawing/svg.h"

namespace mapweld::server::evaluation {
namespace {

using drawing::Axis;
using drawing::kFaintInk;
using drawing::kInk;
using drawing::kRule;
using drawing::px;
using drawing::text_at;

constexpr double kLeft = 78;  // of a panel: room for tick labels and the axis title
constexpr double kRight = 26;
constexpr double kAbove = 34;  // title of the panel
constexpr double kBelow = 58;  // tick labels and axis title
constexpr double kMargin = 12;
constexpr double kSmall = 12;  // text, px

std::string line(double x1, double y1, double x2, double y2, const std::string& stroke, double width,
                 const std::string& dashes = "") {
  std::string text = "<line x1=\"" + px(x1) + "\" y1=\"" + px(y1) + "\" x2=\"" + px(x2) + "\" y2=\"" + px(y2);
  text += "\" stroke=\"" + stroke + "\" stroke-width=\"" + px(width) + "\"";
  if (!dashes.empty()) text += " stroke-dasharray=\"" + dashes + "\"";
  return text + "/>\n";
}

std::string dot(double x, double y, double radius, const std::string& colour, double opacity = 1) {
  std::string text = "<circle cx=\"" + px(x) + "\" cy=\"" + px(y) + "\" r=\"" + px(radius) + "\" fill=\"" + colour;
  if (opacity < 1) text += "\" fill-opacity=\"" + px(opacity);
  return text + "\"/>\n";
}

struct Tick {
  double at_px = 0;
  std::string label;
};

// The x axis of a panel, linear or logarithmic.
class Scale {
 public:
  Scale(const ChartPanel& panel, double from_px, double to_px) : log_(panel.log_x) {
    if (!log_) {
      linear_.emplace(panel.x_most, 6, from_px, to_px, Axis::End::kLast);
      for (const double tick : linear_->ticks()) ticks_.push_back({linear_->at(tick), linear_->label(tick)});
      return;
    }
    least_ = panel.x_least > 0 ? panel.x_least : 1;
    const double most = std::max(panel.x_most, 2 * least_);
    from_px_ = from_px;
    per_decade_px_ = (to_px - from_px) / std::log10(most / least_);
    const double decades = std::log10(most / least_);
    for (double power = std::pow(10, std::floor(std::log10(least_))); power <= most; power *= 10) {
      for (const int lead : {1, 2, 5}) {
        if (lead != 1 && decades > 2.2) continue;
        const double value = lead * power;
        if (value < least_ * 0.999 || value > most * 1.001) continue;
        ticks_.push_back({at(value), drawing::shown(value, 6)});
      }
    }
  }
  bool holds(double value) const { return !log_ || value >= least_; }
  double at(double value) const {
    return log_ ? from_px_ + per_decade_px_ * std::log10(std::max(value, least_) / least_) : linear_->at(value);
  }
  const std::vector<Tick>& ticks() const { return ticks_; }

 private:
  bool log_;
  std::optional<Axis> linear_;
  double least_ = 1;
  double from_px_ = 0;
  double per_decade_px_ = 1;
  std::vector<Tick> ticks_;
};

// Where the line crosses the beginning of a logarithmic axis it is cut, not dropped.
std::vector<ChartPoint> visible(const std::vector<ChartPoint>& points, const Scale& scale) {
  std::vector<ChartPoint> kept;
  std::optional<ChartPoint> before;
  for (const ChartPoint& point : points) {
    if (!scale.holds(point.x)) {
      before = point;
      continue;
    }
    if (before && kept.empty()) kept.push_back({0, before->y});
    kept.push_back(point);
  }
  return kept;
}

// Is the point so near the last one drawn that nobody could tell?
class Thinner {
 public:
  bool drops(double x_px, double y_px, bool is_last) {
    constexpr double kVisible = 0.35;
    if (!is_last && std::abs(x_px - x_px_) < kVisible && std::abs(y_px - y_px_) < kVisible) return true;
    x_px_ = x_px;
    y_px_ = y_px;
    return false;
  }

 private:
  double x_px_ = -1e9;
  double y_px_ = -1e9;
};

std::string draw_band(const ChartSeries& series, const Scale& x, const Axis& y, double y_most) {
  if (series.spread.empty()) return "";
  std::string above, below;
  Thinner thinner;
  for (std::size_t i = 0; i < series.points.size(); ++i) {
    const ChartPoint& point = series.points[i];
    if (!x.holds(point.x) || thinner.drops(x.at(point.x), y.at(point.y), i + 1 == series.points.size())) continue;
    const auto at = [&](double value) { return px(x.at(point.x)) + " " + px(y.at(std::clamp(value, 0.0, y_most))); };
    above += (above.empty() ? "M" : "L") + at(point.y + series.spread[i]);
    below = "L" + at(point.y - series.spread[i]) + below;
  }
  if (above.empty()) return "";
  return "<path d=\"" + above + below + "Z\" fill=\"" + series.style.colour + "\" fill-opacity=\"0.16\"/>\n";
}

std::string draw_series(const ChartSeries& series, const Scale& x, const Axis& y) {
  std::string content;
  if (series.dots) {
    const double radius = series.points.size() > 1500 ? 1.1 : series.points.size() > 300 ? 1.5 : 2.2;
    for (const ChartPoint& point : series.points) {
      if (x.holds(point.x)) content += dot(x.at(point.x), y.at(point.y), radius, series.style.colour, 0.55);
    }
    return content;
  }
  std::string path;
  Thinner thinner;
  const std::vector<ChartPoint> points = visible(series.points, x);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double x_px = x.at(points[i].x), y_px = y.at(points[i].y);
    if (thinner.drops(x_px, y_px, i + 1 == points.size())) continue;
    path += (path.empty() ? "M" : "L") + px(x_px) + " " + px(y_px);
  }
  if (path.empty()) return "";
  content = "<path d=\"" + path + "\" fill=\"none\" stroke=\"" + series.style.colour + "\" stroke-width=\"" +
            px(series.style.width_px) + "\" stroke-linejoin=\"round\"";
  if (!series.style.dashes.empty()) content += " stroke-dasharray=\"" + series.style.dashes + "\"";
  content += "/>\n";
  if (series.marks_end) {
    content += dot(x.at(series.points.back().x), y.at(series.points.back().y), 3.4, series.style.colour);
  }
  return content;
}

std::string draw_x_axis(const ChartPanel& panel, const Scale& x, double left, double right, double bottom) {
  std::string content = line(left, bottom, right, bottom, kInk, 1);
  double free_from = 0;
  for (const Tick& tick : x.ticks()) {
    content += line(tick.at_px, bottom, tick.at_px, bottom + 4, kInk, 1);
    const double half = drawing::text_width_px(tick.label, kSmall) / 2;
    if (tick.at_px - half < free_from) continue;
    content +=
        text_at(tick.at_px, bottom + 18, tick.label, {.size_px = kSmall, .colour = kFaintInk, .anchor = "middle"});
    free_from = tick.at_px + half + 5;
  }
  return content + text_at((left + right) / 2, bottom + 38, panel.x_title, {.size_px = 12.5, .anchor = "middle"});
}

std::string draw_y_axis(const std::string& title, const Axis& y, double left, double right, double top, double bottom) {
  std::string content;
  for (const double tick : y.ticks()) {
    content += line(left, y.at(tick), right, y.at(tick), kRule, 0.8);
    content +=
        text_at(left - 8, y.at(tick) + 4, y.label(tick), {.size_px = kSmall, .colour = kFaintInk, .anchor = "end"});
  }
  content += line(left, top, left, bottom, kInk, 1);
  return content +
         text_at(left - 54, (top + bottom) / 2, title, {.size_px = 12.5, .anchor = "middle", .turned_deg = -90});
}

std::string draw_panel(const ChartPanel& panel, double x_px, double y_px, double width, double height) {
  const double left = x_px + kLeft, right = x_px + width - kRight;
  const double top = y_px + kAbove, bottom = y_px + height - kBelow;
  const Axis y(panel.y_most, panel.y_ticks, bottom, top);
  const Scale x(panel, left, right);
  std::string content = "<g class=\"panel\">\n";
  if (!panel.title.empty()) content += text_at(left, top - 12, panel.title, {.size_px = 13, .bold = true});
  content += draw_y_axis(panel.y_title, y, left, right, top, bottom);
  for (const double guide : panel.guides) content += line(left, y.at(guide), right, y.at(guide), kFaintInk, 1, "5 4");
  for (const ChartSeries& series : panel.series) content += draw_band(series, x, y, y.end());
  for (const ChartSeries& series : panel.series) content += draw_series(series, x, y);
  return content + draw_x_axis(panel, x, left, right, bottom) + "</g>\n";
}

// Title, subtitle and legend; `y_px` moves below them. The legend stands over the panels: it covers nothing.
std::string draw_head(const std::string& title, const std::string& subtitle, const std::vector<LegendEntry>& legend,
                      bool of_bars, double width, double& y_px) {
  const double left = kMargin + 12;
  std::string content = text_at(left, y_px + 30, title, {.size_px = 17, .bold = true});
  y_px += 38;
  if (!subtitle.empty()) {
    content += text_at(left, y_px + 14, subtitle, {.size_px = 12.5, .colour = kFaintInk});
    y_px += 20;
  }
  double x = left;
  y_px += 12;
  for (const LegendEntry& entry : legend) {
    const double needed = 36 + drawing::text_width_px(entry.name, 13) + 20;
    if (x > left && x + needed > width - kMargin) {
      x = left;
      y_px += 20;
    }
    content += of_bars ? line(x + 8, y_px + 8, x + 28, y_px + 8, entry.style.colour, 13)
                       : line(x, y_px + 8, x + 28, y_px + 8, entry.style.colour, 1.5 * entry.style.width_px,
                              entry.style.dashes);
    content += text_at(x + 36, y_px + 12.5, entry.name, {.size_px = 13});
    x += needed;
  }
  y_px += legend.empty() ? 0 : 22;
  return content;
}

}  // namespace

std::string chart_svg(const Chart& chart) {
  const double width = 2 * kMargin + chart.columns * chart.panel_width_px;
  double y_px = 0;
  std::string content = draw_head(chart.title, chart.subtitle, chart.legend, false, width, y_px);
  const int rows = (static_cast<int>(chart.panels.size()) + chart.columns - 1) / chart.columns;
  for (std::size_t i = 0; i < chart.panels.size(); ++i) {
    const int row = static_cast<int>(i) / chart.columns, column = static_cast<int>(i) % chart.columns;
    content += draw_panel(chart.panels[i], kMargin + column * chart.panel_width_px, y_px + row * chart.panel_height_px,
                          chart.panel_width_px, chart.panel_height_px);
  }
  return drawing::svg_document(width, y_px + rows * chart.panel_height_px + kMargin, chart.title, content);
}

std::string bar_chart_svg(const BarChart& chart) {
  constexpr double kBar = 44, kBetweenBars = 10, kBetweenGroups = 52, kHeight = 260;
  double plot = kBetweenGroups / 2;
  for (const BarGroup& group : chart.groups) {
    plot += static_cast<double>(group.bars.size()) * (kBar + kBetweenBars) + kBetweenGroups;
  }
  const double left = kMargin + kLeft;
  const double width = std::max(560.0, left + plot + kRight);
  double y_px = 0;
  std::string content = draw_head(chart.title, chart.subtitle, chart.legend, true, width, y_px);
  const double top = y_px + 26, bottom = top + kHeight, right = width - kRight;
  const Axis y(chart.y_most, 5, bottom, top);
  content += draw_y_axis(chart.y_title, y, left, right, top, bottom);
  double x = left + kBetweenGroups / 2;
  for (const BarGroup& group : chart.groups) {
    const double from = x;
    for (const Bar& bar : group.bars) {
      const double height = y.at(0) - y.at(std::min(bar.value, y.end()));
      content += "<rect x=\"" + px(x) + "\" y=\"" + px(bottom - height) + "\" width=\"" + px(kBar) + "\" height=\"" +
                 px(height) + "\" fill=\"" + bar.style.colour + "\"/>\n";
      double label_y = bottom - height - 6;
      if (bar.deviation > 0) {
        const double centre = x + kBar / 2;
        const double high = y.at(std::min(bar.value + bar.deviation, y.end()));
        const double low = y.at(std::max(0.0, bar.value - bar.deviation));
        content += line(centre, high, centre, low, kInk, 1.4) + line(centre - 6, high, centre + 6, high, kInk, 1.4) +
                   line(centre - 6, low, centre + 6, low, kInk, 1.4);
        label_y = high - 6;
      }
      content += text_at(x + kBar / 2, label_y, bar.label, {.size_px = kSmall, .anchor = "middle", .halo = true});
      x += kBar + kBetweenBars;
    }
    double text_y = bottom + 18;
    for (const std::string& name : group.name) {
      content += text_at((from + x - kBetweenBars) / 2, text_y, name, {.size_px = kSmall, .anchor = "middle"});
      text_y += 16;
    }
    x += kBetweenGroups;
  }
  content += line(left, bottom, right, bottom, kInk, 1);
  return drawing::svg_document(width, bottom + 64, chart.title, content);
}

ChartStyle style_of_method(std::string_view method) {
  static constexpr std::array<std::array<std::string_view, 3>, 7> kStyles{{
      {"quickconnect", "#D55E00", ""},
      {"brute-force", "#1F2328", "7 4"},
      {"random", "#0072B2", ""},
      {"random-candidates", "#56B4E9", "8 3"},
      {"degree-min", "#009E73", ""},
      {"alignment", "#CC79A7", "9 3 2 3"},
      {"spectral", "#E69F00", ""},
  }};
  for (const auto& [name, colour, dashes] : kStyles) {
    if (name == method) return {std::string(colour), std::string(dashes)};
  }
  return {"#8C6D1F", "3 3"};
}

}  // namespace mapweld::server::evaluation
