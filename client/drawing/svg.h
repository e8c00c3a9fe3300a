// Writing SVG 1.1 by hand: elements as strings, numbers short, text safe. And the look that all figures share.
#pragma once

#include <string>
#include <string_view>

namespace mapweld::drawing {

// Colours that stay apart for the common forms of colour blindness (Okabe & Ito 2008, "Color universal design"), on a
// white ground.
inline constexpr const char* kMemberColours[] = {"#0072B2", "#009E73", "#E69F00", "#CC79A7", "#56B4E9", "#8C6D1F"};
inline constexpr int kMemberColourCount = 6;
inline constexpr const char* kInterColour = "#D01C2B";  // edges between maps: the paper's red
inline constexpr const char* kInnerColour = "#9AA1A9";  // edges within a map
inline constexpr const char* kInk = "#1F2328";
inline constexpr const char* kFaintInk = "#626A73";
inline constexpr const char* kRule = "#D5D9DE";
inline constexpr const char* kFont = "Helvetica, Arial, 'Liberation Sans', 'DejaVu Sans', sans-serif";

// Two decimals, without trailing zeros: "12.5".
std::string px(double number);

// For text and attribute values: markup escaped; bytes that XML cannot hold replaced by U+FFFD.
std::string escaped(std::string_view text);

// "2.5", "0.0131", "1e-05": for people.
std::string shown(double number, int digits = 4);

// A document of this size with a white ground; `label` says to screen readers what it shows.
std::string svg_document(double width_px, double height_px, std::string_view label, std::string_view content);

struct TextStyle {
  double size_px = 13;
  const char* colour = kInk;
  const char* anchor = "start";  // "start", "middle", "end"
  bool bold = false;
  bool halo = false;      // a white rim, over lines
  double turned_deg = 0;  // about its own position
};
std::string text_at(double x_px, double y_px, std::string_view text, const TextStyle& style = {});

// How wide a text comes out in the figures' font, about: for laying out legends.
double text_width_px(std::string_view text, double size_px);

}  // namespace mapweld::drawing
