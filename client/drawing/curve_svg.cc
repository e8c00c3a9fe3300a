#include "client/drawing/curve_svg.h"

#include <algorithm>
#include <functional>
#include <optional>
#include <vector>

#include "client/drawing/axis.h"
#include "client/drawing/svg.h"

namespace mapweld::drawing {
namespace {

using contract::CurvePoint;
using Points = std::span<const CurvePoint>;

constexpr double kWidth = 900;
constexpr double kLeft = 92;
constexpr double kRight = kWidth - 76;
constexpr double kTop = 122;
constexpr double kPanelGap = 34;

struct PanelSpec {
  std::string title;
  const char* colour;
  double height_px;
  int ticks;
  double most;
  std::function<double(const CurvePoint&)> value;
  bool of_component;  // says little while the largest component grows: dotted until then
  std::function<double(const CurvePoint&)> beyond = {};  // what `value` is a part of: a thin grey line
};

double verified(const CurvePoint& point) { return static_cast<double>(point.edges); }
double confirmed(const CurvePoint& point) {
  return point.edge_counts ? static_cast<double>(point.edge_counts->confirmed) : verified(point);
}

std::string line(double x1, double y1, double x2, double y2, const std::string& style) {
  return "<line x1=\"" + px(x1) + "\" y1=\"" + px(y1) + "\" x2=\"" + px(x2) + "\" y2=\"" + px(y2) + "\" " + style +
         "/>\n";
}

// Consecutive points of one phase, from the first one's time to the first one's of the next phase.
struct Band {
  std::string phase;
  double from_s;
  double to_s;
};
std::vector<Band> bands_of(Points points) {
  std::vector<Band> bands;
  for (const CurvePoint& point : points) {
    if (bands.empty() || bands.back().phase != point.phase) {
      if (!bands.empty()) bands.back().to_s = point.elapsed_s;
      bands.push_back({point.phase, bands.empty() ? 0 : point.elapsed_s, point.elapsed_s});
    }
    bands.back().to_s = point.elapsed_s;
  }
  return bands;
}

std::string draw_bands(const std::vector<Band>& bands, const Axis& time, double top, double bottom) {
  std::string content = "<g class=\"phases\">\n";
  double free_from = 0;  // labels do not run into each other
  for (std::size_t i = 0; i < bands.size(); ++i) {
    const double left = time.at(bands[i].from_s);
    const double right = time.at(bands[i].to_s);
    if (i % 2 == 1) {
      content += "<rect x=\"" + px(left) + "\" y=\"" + px(top) + "\" width=\"" + px(right - left) + "\" height=\"" +
                 px(bottom - top) + "\" fill=\"#F3F5F8\"/>\n";
    }
    if (i > 0) {
      content += line(left, top, left, bottom,
                      std::string("stroke=\"") + kFaintInk + "\" stroke-width=\"0.8\" stroke-dasharray=\"2 3\"");
    }
    const double width = text_width_px(bands[i].phase, 12);
    const double centre = std::max((left + right) / 2, free_from + width / 2);
    const bool fits = right - left > width + 8 || (centre == (left + right) / 2 && centre + width / 2 < kRight);
    if (fits && bands[i].phase != "done") {
      content += text_at(centre, top - 7, bands[i].phase, {.size_px = 12, .colour = kFaintInk, .anchor = "middle"});
      free_from = centre + width / 2 + 8;
    }
  }
  return content + "</g>\n";
}

// How many points come before the largest component has its last size for good. Its connectivity says little until
// then: a small component is easily better connected than the one it becomes part of.
std::size_t growing(Points points) {
  std::size_t first = points.size();
  while (first > 0 && points[first - 1].largest_component.vertices == points.back().largest_component.vertices) --first;
  return first;
}

// The first time from which on the component that remains keeps 90 % of its last connectivity or more.
std::optional<double> settled_s(Points points) {
  const double goal = 0.9 * points.back().largest_component.algebraic_connectivity;
  if (!(goal > 0)) return std::nullopt;
  const std::size_t grown = growing(points);
  std::size_t first = points.size();
  while (first > grown && points[first - 1].largest_component.algebraic_connectivity >= goal) --first;
  return first < points.size() ? std::optional(points[first].elapsed_s) : std::nullopt;
}

std::string draw_line(const std::function<double(const CurvePoint&)>& value, const char* colour, Points points,
                      const Axis& time, const Axis& axis, const char* style) {
  if (points.size() < 2) return "";
  std::string path;
  for (const CurvePoint& point : points) {
    path += path.empty() ? "M" : "L";
    path += px(time.at(point.elapsed_s)) + " " + px(axis.at(value(point)));
  }
  return "<path d=\"" + path + "\" fill=\"none\" stroke=\"" + colour + "\" " + style +
         " stroke-linejoin=\"round\" stroke-linecap=\"round\"/>\n";
}

std::string draw_panel(const PanelSpec& panel, Points points, const Axis& time, double top) {
  const double bottom = top + panel.height_px;
  const Axis axis(panel.most, panel.ticks, bottom, top);
  std::string content = "<g class=\"panel\">\n";
  for (const double tick : axis.ticks()) {
    const double y = axis.at(tick);
    content += line(kLeft, y, kRight, y, std::string("stroke=\"") + kRule + "\" stroke-width=\"0.8\"");
    content += text_at(kLeft - 9, y + 4, axis.label(tick), {.size_px = 12, .colour = kFaintInk, .anchor = "end"});
  }
  content += line(kLeft, top, kLeft, bottom, std::string("stroke=\"") + kInk + "\" stroke-width=\"1\"");
  content += line(kLeft, bottom, kRight, bottom, std::string("stroke=\"") + kInk + "\" stroke-width=\"1\"");
  for (const double tick : time.ticks()) {
    content += line(time.at(tick), bottom, time.at(tick), bottom + 4,
                    std::string("stroke=\"") + kInk + "\" stroke-width=\"1\"");
  }
  content += text_at(26, (top + bottom) / 2, panel.title,
                     {.size_px = 12.5, .colour = kInk, .anchor = "middle", .turned_deg = -90});
  const std::size_t dashed = panel.of_component ? growing(points) : 0;
  if (panel.beyond) content += draw_line(panel.beyond, kFaintInk, points, time, axis, "stroke-width=\"1.2\"");
  content += draw_line(panel.value, panel.colour, points.first(std::min(dashed + 1, points.size())), time, axis,
                       "stroke-width=\"1.6\" stroke-dasharray=\"1 4\"");
  content += draw_line(panel.value, panel.colour, points.subspan(dashed), time, axis, "stroke-width=\"2\"");
  if (points.size() <= 80) {
    for (const CurvePoint& point : points) {
      content += "<circle cx=\"" + px(time.at(point.elapsed_s)) + "\" cy=\"" + px(axis.at(panel.value(point))) +
                 "\" r=\"2.4\" fill=\"" + panel.colour + "\"/>\n";
    }
  }
  return content + "</g>\n";
}

// The per cent of the final value on the right of the first panel, and the line at 90 %.
std::string draw_share(Points points, const PanelSpec& panel, const Axis& time, double top, bool complete) {
  const double last = panel.value(points.back());
  if (!(last > 0)) return "";
  const Axis axis(panel.most, panel.ticks, top + panel.height_px, top);
  std::string content = "<g class=\"share\">\n";
  constexpr double kLabelHeight = 14;
  const bool room_for_quarters = axis.at(0) - axis.at(last / 4) >= kLabelHeight;
  for (const int percent : {0, 25, 50, 75, 100}) {
    const double y = axis.at(last * percent / 100);
    if (y < top - 1) break;
    if (percent < 100 && !room_for_quarters) continue;
    content += line(kRight, y, kRight + 4, y, std::string("stroke=\"") + kFaintInk + "\" stroke-width=\"1\"");
    content += text_at(kRight + 9, y + 4, std::to_string(percent) + " %", {.size_px = 12, .colour = kFaintInk});
  }
  content += text_at(kWidth - 16, top + panel.height_px / 2, complete ? "of the final value" : "of the last value",
                     {.size_px = 12, .colour = kFaintInk, .anchor = "middle", .turned_deg = 90});
  const auto reached_s = complete ? settled_s(points) : std::nullopt;
  if (reached_s) {
    const double x = time.at(*reached_s);
    const double y = axis.at(0.9 * last);
    const std::string dashes = std::string("stroke=\"") + kInk + "\" stroke-width=\"0.9\" stroke-dasharray=\"5 4\"";
    content += line(x, y, kRight, y, dashes) + line(x, y, x, top + panel.height_px, dashes);
    const double total_s = points.back().elapsed_s;
    const std::string text = "90 % after " + shown(*reached_s, 3) + " s, " +
                             std::to_string(static_cast<int>(100 * *reached_s / std::max(total_s, 1e-9) + 0.5)) +
                             " % of the time";
    const bool room_right = x + 8 + text_width_px(text, 12) < kRight;
    content += text_at(room_right ? x + 8 : x - 8, top + panel.height_px - 10, text,
                       {.size_px = 12, .colour = kInk, .anchor = room_right ? "start" : "end", .halo = true});
  }
  return content + "</g>\n";
}

std::string subtitle_of(const contract::Merge& merge, Points points) {
  std::string text = merge.method + ", " + merge.state;
  if (!points.empty()) {
    const CurvePoint& last = points.back();
    text += ": " + std::to_string(last.edges) + " verified edges between the maps";
    if (last.edge_counts) text += ", " + std::to_string(last.edge_counts->confirmed) + " of them confirmed";
    text += "; " + std::to_string(last.verifications) + " verifications, " + std::to_string(last.components) +
            (last.components == 1 ? " component" : " components") + " after " + shown(last.elapsed_s, 3) + " s";
  }
  return text;
}

}  // namespace

std::string curve_svg(const contract::Merge& merge, Points points) {
  std::string maps;
  for (const std::string& map : merge.maps) {
    if (!maps.empty()) maps += " + ";
    maps += map;
  }
  const std::string title = "Merge " + std::to_string(merge.id) + ": " + maps + " \u2192 " + merge.map;
  std::string content = text_at(kLeft - 56, 46, title, {.size_px = 20, .bold = true});
  content += text_at(kLeft - 56, 69, subtitle_of(merge, points), {.size_px = 13, .colour = kFaintInk});
  if (points.empty()) {
    content += text_at(kWidth / 2, 150, "No point of the curve has been measured yet.",
                       {.size_px = 14, .colour = kFaintInk, .anchor = "middle"});
    return svg_document(kWidth, 240, title, content);
  }

  const auto most = [&](const auto& value) {
    double largest = 0;
    for (const CurvePoint& point : points) largest = std::max(largest, value(point));
    return largest;
  };
  const auto connectivity = [](const CurvePoint& p) { return p.largest_component.algebraic_connectivity; };
  const auto size = [](const CurvePoint& p) { return static_cast<double>(p.largest_component.vertices); };
  std::vector<PanelSpec> panels = {
      {"algebraic connectivity \u03BB\u2082", kMemberColours[0], 240, 5, most(connectivity), connectivity, true},
      {"edges between maps", kInterColour, 150, 4, most(verified), confirmed, false}};
  if (std::ranges::any_of(points, [](const CurvePoint& p) { return confirmed(p) != verified(p); })) {
    panels.back().title = "edges: red confirmed";
    panels.back().beyond = verified;
  }
  if (std::any_of(points.begin(), points.end(), [&](const CurvePoint& p) { return size(p) != size(points.back()); })) {
    panels.push_back({"vertices in largest", kMemberColours[1], 110, 3, most(size), size, false});
  }
  double bottom = kTop;
  for (const PanelSpec& panel : panels) bottom += panel.height_px + kPanelGap;
  bottom -= kPanelGap;

  const Axis time(points.back().elapsed_s, 8, kLeft, kRight, Axis::End::kLast);
  content += draw_bands(bands_of(points), time, kTop, bottom);
  double top = kTop;
  for (std::size_t i = 0; i < panels.size(); ++i) {
    content += draw_panel(panels[i], points, time, top);
    if (i == 0) content += draw_share(points, panels[0], time, top, merge.state == "completed");
    top += panels[i].height_px + kPanelGap;
  }
  for (const double tick : time.ticks()) {
    content +=
        text_at(time.at(tick), bottom + 20, time.label(tick), {.size_px = 12, .colour = kFaintInk, .anchor = "middle"});
  }
  content += text_at((kLeft + kRight) / 2, bottom + 42, "time of the merge (s)", {.size_px = 12.5, .anchor = "middle"});
  return svg_document(kWidth, bottom + 62, title, content);
}

}  // namespace mapweld::drawing
