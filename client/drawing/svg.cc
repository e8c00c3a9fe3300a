#include "client/drawing/svg.h"

#include <cstdint>
#include <cstdio>

namespace mapweld::drawing {
namespace {

constexpr std::string_view kReplacement = "\xEF\xBF\xBD";

// Length of the well-formed UTF-8 sequence at the front of `text`, 0 when there is none.
std::size_t sequence_length(std::string_view text) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  const unsigned lead = byte(0);
  if (lead < 0x80) return 1;
  const std::size_t length = lead >= 0xF0 ? 4 : lead >= 0xE0 ? 3 : 2;
  if (lead < 0xC2 || lead > 0xF4 || text.size() < length) return 0;
  for (std::size_t i = 1; i < length; ++i) {
    if ((byte(i) & 0xC0U) != 0x80) return 0;
  }
  const unsigned second = byte(1);
  const bool overlong = (lead == 0xE0 && second < 0xA0) || (lead == 0xF0 && second < 0x90);
  const bool beyond = (lead == 0xED && second > 0x9F) || (lead == 0xF4 && second > 0x8F);
  return overlong || beyond ? 0 : length;
}

}  // namespace

std::string px(double number) {
  char text[48];
  std::snprintf(text, sizeof text, "%.2f", number);
  std::string shortened = text;
  shortened.erase(shortened.find_last_not_of('0') + 1);
  if (shortened.back() == '.') shortened.pop_back();
  return shortened == "-0" ? "0" : shortened;
}

std::string escaped(std::string_view text) {
  std::string safe;
  while (!text.empty()) {
    const std::size_t length = sequence_length(text);
    const auto lead = static_cast<unsigned char>(text[0]);
    const std::string_view piece = text.substr(0, length == 0 ? 1 : length);
    const bool forbidden = length == 0 || (lead < 0x20 && lead != '\t' && lead != '\n') || piece == "\xEF\xBF\xBE" ||
                           piece == "\xEF\xBF\xBF";
    if (forbidden) {
      safe += kReplacement;
    } else if (lead == '&') {
      safe += "&amp;";
    } else if (lead == '<') {
      safe += "&lt;";
    } else if (lead == '>') {
      safe += "&gt;";
    } else if (lead == '"') {
      safe += "&quot;";
    } else {
      safe += piece;
    }
    text.remove_prefix(piece.size());
  }
  return safe;
}

std::string shown(double number, int digits) {
  char text[48];
  std::snprintf(text, sizeof text, "%.*g", digits, number);
  return text;
}

std::string svg_document(double width_px, double height_px, std::string_view label, std::string_view content) {
  const std::string width = px(width_px);
  const std::string height = px(height_px);
  std::string document =
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"";
  document += width + "\" height=\"" + height + "\" viewBox=\"0 0 " + width + " " + height;
  document += "\" role=\"img\" aria-label=\"" + escaped(label) + "\" font-family=\"" + kFont + "\">\n";
  document += "<title>" + escaped(label) + "</title>\n";
  document += "<rect width=\"" + width + "\" height=\"" + height + "\" fill=\"#FFFFFF\"/>\n";
  document += content;
  document += "</svg>\n";
  return document;
}

std::string text_at(double x_px, double y_px, std::string_view text, const TextStyle& style) {
  std::string element = "<text x=\"" + px(x_px) + "\" y=\"" + px(y_px) + "\" font-size=\"" + px(style.size_px);
  element += "\" fill=\"" + std::string(style.colour) + "\"";
  if (std::string_view(style.anchor) != "start") element += " text-anchor=\"" + std::string(style.anchor) + "\"";
  if (style.halo) element += " stroke=\"#FFFFFF\" stroke-width=\"4\" stroke-linejoin=\"round\" paint-order=\"stroke\"";
  if (style.bold) element += " font-weight=\"600\"";
  if (style.turned_deg != 0) {
    element += " transform=\"rotate(" + px(style.turned_deg) + " " + px(x_px) + " " + px(y_px) + ")\"";
  }
  return element + ">" + escaped(text) + "</text>\n";
}

double text_width_px(std::string_view text, double size_px) {
  double ems = 0;
  for (const char c : text) {
    if ((static_cast<unsigned char>(c) & 0xC0U) == 0x80) continue;
    const bool narrow = c == ' ' || c == '.' || c == ',' || c == 'i' || c == 'l' || c == 't' || c == 'f' || c == 'j';
    const bool wide = (c >= 'A' && c <= 'Z') || c == 'm' || c == 'w';
    ems += narrow ? 0.36 : wide ? 0.76 : 0.63;
  }
  return ems * size_px;
}

}  // namespace mapweld::drawing
