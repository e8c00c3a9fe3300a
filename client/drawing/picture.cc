#include "client/drawing/picture.h"

#include <cstdint>
#include <stdexcept>

#include <cairo-svg.h>
#include <gdk-pixbuf/gdk-pixbuf.h>

namespace mapweld::drawing {
namespace {

struct Unref {
  void operator()(gpointer object) const { g_object_unref(object); }
};
struct FreeContext {
  void operator()(cairo_t* context) const { cairo_destroy(context); }
};
using Context = std::unique_ptr<cairo_t, FreeContext>;

void require(cairo_status_t status) {
  if (status != CAIRO_STATUS_SUCCESS) {
    throw std::runtime_error(std::string("The picture cannot be drawn: ") + cairo_status_to_string(status) + ".");
  }
}

cairo_status_t append(void* bytes, const unsigned char* data, unsigned int count) {
  static_cast<std::string*>(bytes)->append(reinterpret_cast<const char*>(data), count);
  return CAIRO_STATUS_SUCCESS;
}

void draw_on(cairo_surface_t* paper, const std::function<void(cairo_t*)>& draw) {
  const Context context(cairo_create(paper));
  cairo_set_source_rgb(context.get(), 1, 1, 1);
  cairo_paint(context.get());
  draw(context.get());
  require(cairo_status(context.get()));
}

Picture blank(int width_px, int height_px) {
  Picture picture(cairo_image_surface_create(CAIRO_FORMAT_RGB24, width_px, height_px));
  require(cairo_surface_status(picture.get()));
  return picture;
}

}  // namespace

void FreeSurface::operator()(cairo_surface_t* surface) const { cairo_surface_destroy(surface); }

int width_px(const Picture& picture) { return cairo_image_surface_get_width(picture.get()); }
int height_px(const Picture& picture) { return cairo_image_surface_get_height(picture.get()); }

Picture decode_picture(std::string_view bytes) {
  const std::unique_ptr<GdkPixbufLoader, Unref> loader(gdk_pixbuf_loader_new());
  const auto* data = reinterpret_cast<const guchar*>(bytes.data());
  GError* error = nullptr;
  const bool written = gdk_pixbuf_loader_write(loader.get(), data, bytes.size(), &error) != 0;
  // A loader is to be closed in any case; what it says then counts only when nothing was wrong before.
  const bool closed = gdk_pixbuf_loader_close(loader.get(), written ? &error : nullptr) != 0;
  if (!written || !closed) {
    const std::string why = error != nullptr ? error->message : "unknown";
    g_clear_error(&error);
    throw std::runtime_error("An image cannot be decoded: " + why + ".");
  }
  GdkPixbuf* const stored = gdk_pixbuf_loader_get_pixbuf(loader.get());
  if (stored == nullptr) throw std::runtime_error("An image cannot be decoded: it has no pixels.");
  const std::unique_ptr<GdkPixbuf, Unref> upright(gdk_pixbuf_apply_embedded_orientation(stored));
  const int channels = gdk_pixbuf_get_n_channels(upright.get());
  Picture picture = blank(gdk_pixbuf_get_width(upright.get()), gdk_pixbuf_get_height(upright.get()));
  cairo_surface_flush(picture.get());
  for (int y = 0; y < height_px(picture); ++y) {
    const guchar* from = gdk_pixbuf_read_pixels(upright.get()) +
                         static_cast<std::ptrdiff_t>(y) * gdk_pixbuf_get_rowstride(upright.get());
    auto* to = reinterpret_cast<std::uint32_t*>(cairo_image_surface_get_data(picture.get()) +
                                                static_cast<std::ptrdiff_t>(y) *
                                                    cairo_image_surface_get_stride(picture.get()));
    for (int x = 0; x < width_px(picture); ++x, from += channels) {
      to[x] = std::uint32_t{from[0]} << 16 | std::uint32_t{from[1]} << 8 | std::uint32_t{from[2]};
    }
  }
  cairo_surface_mark_dirty(picture.get());
  return picture;
}

std::string png_of(int width_px, int height_px, const std::function<void(cairo_t*)>& draw) {
  const Picture paper = blank(width_px, height_px);
  draw_on(paper.get(), draw);
  std::string bytes;
  require(cairo_surface_write_to_png_stream(paper.get(), append, &bytes));
  return bytes;
}

std::string svg_of(int width_px, int height_px, const std::function<void(cairo_t*)>& draw) {
  std::string bytes;
  const Picture paper(cairo_svg_surface_create_for_stream(append, &bytes, width_px, height_px));
  require(cairo_surface_status(paper.get()));
  cairo_svg_surface_set_document_unit(paper.get(), CAIRO_SVG_UNIT_PX);
  draw_on(paper.get(), draw);
  cairo_surface_finish(paper.get());
  require(cairo_surface_status(paper.get()));
  return bytes;
}

}  // namespace mapweld::drawing
