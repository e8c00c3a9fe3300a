#include "client/drawing/pair_figure.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string_view>

#include "client/drawing/picture.h"

namespace mapweld::drawing {
namespace {

constexpr double kMargin = 20;
constexpr double kGap = 16;  // between the images
constexpr double kTitleBaseline = 34;
constexpr double kSubtitleBaseline = 56;
constexpr double kCaptionBaseline = 86;
constexpr double kImagesTop = 96;
constexpr double kMaxSide = 800;
constexpr double kMaxZoom = 2;
constexpr double kMinWidth = 480;  // of the figure, for its title
constexpr double kDotRadius = 3;
constexpr const char* kFont = "sans-serif";

struct Colour {
  double red;
  double green;
  double blue;
};
constexpr Colour kInk = {0.12, 0.14, 0.16};  // as in the other figures, svg.h
constexpr Colour kFaintInk = {0.38, 0.42, 0.45};

// Bright and dark colours in turn, hues apart by the golden angle: near numbers have unlike colours.
Colour colour_of(std::size_t number) {
  const double hue = 6 * std::fmod(static_cast<double>(number) * 0.618033988749895, 1.0);
  const double value = number % 2 == 0 ? 1.0 : 0.8;
  const auto channel = [&](double shift) {
    const double at = std::fmod(hue + shift, 6.0);
    return value * std::clamp(std::abs(at - 3) - 1, 0.0, 1.0);
  };
  return {channel(0), channel(4), channel(2)};
}

void set_colour(cairo_t* context, const Colour& colour, double opacity = 1) {
  cairo_set_source_rgba(context, colour.red, colour.green, colour.blue, opacity);
}

double width_of(cairo_t* context, const std::string& text) {
  cairo_text_extents_t extents;
  cairo_text_extents(context, text.c_str(), &extents);
  return extents.x_advance;
}

// The text, or as much of its beginning as fits, with an ellipsis.
std::string fitted(cairo_t* context, std::string text, double width_px) {
  if (width_of(context, text) <= width_px) return text;
  constexpr const char* kEllipsis = "\xE2\x80\xA6";
  const auto is_continuation = [](char c) { return (static_cast<unsigned char>(c) & 0xC0U) == 0x80; };
  while (!text.empty() && width_of(context, text + kEllipsis) > width_px) {
    while (is_continuation(text.back())) text.pop_back();
    text.pop_back();
  }
  return text + kEllipsis;
}

struct TextLine {
  double x_px;
  double baseline_px;
  double size_px;
  double width_px;  // at most
  bool bold = false;
  Colour colour = kInk;
};

void write(cairo_t* context, const std::string& text, const TextLine& line) {
  cairo_select_font_face(context, kFont, CAIRO_FONT_SLANT_NORMAL,
                         line.bold ? CAIRO_FONT_WEIGHT_BOLD : CAIRO_FONT_WEIGHT_NORMAL);
  cairo_set_font_size(context, line.size_px);
  set_colour(context, line.colour);
  cairo_move_to(context, line.x_px, line.baseline_px);
  cairo_show_text(context, fitted(context, text, line.width_px).c_str());
}

Picture decoded(const FigureImage& image) {
  Picture picture = decode_picture(image.bytes);
  if (width_px(picture) != image.width_px || height_px(picture) != image.height_px) {
    throw std::runtime_error("An image is " + std::to_string(width_px(picture)) + "x" +
                             std::to_string(height_px(picture)) + ", not " + std::to_string(image.width_px) + "x" +
                             std::to_string(image.height_px) + " as the map has it.");
  }
  return picture;
}

void place_image(cairo_t* context, const Picture& picture, const ImagePlace& place) {
  cairo_save(context);
  cairo_translate(context, place.left_px, place.top_px);
  cairo_scale(context, place.zoom, place.zoom);
  cairo_rectangle(context, 0, 0, width_px(picture), height_px(picture));
  cairo_set_source_surface(context, picture.get(), 0, 0);
  cairo_pattern_set_extend(cairo_get_source(context), CAIRO_EXTEND_PAD);  // no light seam at the rim
  cairo_fill(context);
  cairo_restore(context);
}

void draw_dot(cairo_t* context, double x_px, double y_px, const Colour& colour) {
  cairo_new_sub_path(context);
  cairo_arc(context, x_px, y_px, kDotRadius, 0, 2 * std::numbers::pi);
  set_colour(context, colour);
  cairo_fill_preserve(context);
  set_colour(context, {1, 1, 1}, 0.8);
  cairo_set_line_width(context, 1);
  cairo_stroke(context);
}

struct Line {
  double from_x, from_y, to_x, to_y;
};

// From the highest to the lowest, so that colours by number differ between neighbours.
std::vector<Line> lines_of(const std::vector<contract::PointMatch>& matches, const PairLayout& layout) {
  std::vector<Line> lines;
  lines.reserve(matches.size());
  for (const contract::PointMatch& match : matches) {
    lines.push_back({layout.u.x_px(match.u), layout.u.y_px(match.u), layout.v.x_px(match.v), layout.v.y_px(match.v)});
  }
  std::ranges::stable_sort(lines, {}, [](const Line& line) { return line.from_y + line.to_y; });
  return lines;
}

void draw_lines(cairo_t* context, const std::vector<Line>& lines) {
  // All lines first: no line hides a dot.
  for (std::size_t i = 0; i < lines.size(); ++i) {
    cairo_move_to(context, lines[i].from_x, lines[i].from_y);
    cairo_line_to(context, lines[i].to_x, lines[i].to_y);
    set_colour(context, colour_of(i), 0.75);
    cairo_set_line_width(context, 1.2);
    cairo_stroke(context);
  }
  for (std::size_t i = 0; i < lines.size(); ++i) {
    draw_dot(context, lines[i].from_x, lines[i].from_y, colour_of(i));
    draw_dot(context, lines[i].to_x, lines[i].to_y, colour_of(i));
  }
}

using Render = std::string (*)(int, int, const std::function<void(cairo_t*)>&);

std::string render(const PairFigure& figure, Render to_file) {
  const Picture u = decoded(figure.u);
  const Picture v = decoded(figure.v);
  const PairLayout layout = layout_pair(figure.u, figure.v);
  const double text_width = layout.width_px - 2 * kMargin;
  return to_file(layout.width_px, layout.height_px, [&](cairo_t* context) {
    write(context, figure.title, {kMargin, kTitleBaseline, 17, text_width, true});
    write(context, figure.subtitle, {kMargin, kSubtitleBaseline, 13, text_width, false, kFaintInk});
    write(context, figure.u.caption, {layout.u.left_px, kCaptionBaseline, 13, layout.u.zoom * figure.u.width_px});
    write(context, figure.v.caption, {layout.v.left_px, kCaptionBaseline, 13, layout.v.zoom * figure.v.width_px});
    place_image(context, u, layout.u);
    place_image(context, v, layout.v);
    draw_lines(context, lines_of(figure.matches, layout));
  });
}

}  // namespace

PairLayout layout_pair(const FigureImage& u, const FigureImage& v) {
  const auto zoom_of = [](const FigureImage& image) {
    return std::min({kMaxZoom, kMaxSide / std::max(image.width_px, 1), kMaxSide / std::max(image.height_px, 1)});
  };
  PairLayout layout;
  layout.u = {kMargin, kImagesTop, zoom_of(u)};
  layout.v = {std::round(kMargin + layout.u.zoom * u.width_px + kGap), kImagesTop, zoom_of(v)};
  layout.width_px =
      static_cast<int>(std::ceil(std::max(layout.v.left_px + layout.v.zoom * v.width_px + kMargin, kMinWidth)));
  layout.height_px = static_cast<int>(
      std::ceil(kImagesTop + std::max(layout.u.zoom * u.height_px, layout.v.zoom * v.height_px) + kMargin));
  return layout;
}

std::string pair_png(const PairFigure& figure) { return render(figure, png_of); }
std::string pair_svg(const PairFigure& figure) { return render(figure, svg_of); }

}  // namespace mapweld::drawing
