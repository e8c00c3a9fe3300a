// Pictures in memory: photographs that are taken apart, drawings that become files.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <string_view>

#include <cairo.h>

namespace mapweld::drawing {

struct FreeSurface {
  void operator()(cairo_surface_t* surface) const;
};
// A cairo image surface of opaque colour (CAIRO_FORMAT_RGB24).
using Picture = std::unique_ptr<cairo_surface_t, FreeSurface>;

int width_px(const Picture& picture);
int height_px(const Picture& picture);

// The pixels of a JPEG or PNG, upright (EXIF orientation applied; a PNG's, which is rare, is not), 8 bits a channel,
// transparency ignored. Throws std::runtime_error for what is neither. Of a file that breaks off, which no server
// takes, what is there.
Picture decode_picture(std::string_view bytes);

// What `draw` draws on white paper of this size, as the bytes of a file. The unit is the pixel, its origin the upper
// left corner of the upper left pixel. Text in an SVG is outlines: it looks the same everywhere. Numbers in its ids
// count on within a process. Throws std::runtime_error when the drawing cannot be made.
std::string png_of(int width_px, int height_px, const std::function<void(cairo_t*)>& draw);
std::string svg_of(int width_px, int height_px, const std::function<void(cairo_t*)>& draw);

}  // namespace mapweld::drawing
