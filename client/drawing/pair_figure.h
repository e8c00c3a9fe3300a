// Two images side by side, with lines between what they have in common.
#pragma once

#include <string>
#include <vector>

#include "client/contract/pair.h"

namespace mapweld::drawing {

struct FigureImage {
  std::string bytes;  // JPEG or PNG
  int width_px = 0;   // as the map has it, upright
  int height_px = 0;
  std::string caption;  // stands above it, cut to its width
};

struct PairFigure {
  std::string title;     // in bold
  std::string subtitle;  // below it, fainter
  FigureImage u;         // on the left
  FigureImage v;         // on the right
  std::vector<contract::PointMatch> matches;
};

// Where an image comes to lie: enlarged up to twice, or reduced, until it fits into 800 x 800 px.
struct ImagePlace {
  double left_px = 0;
  double top_px = 0;
  double zoom = 1;  // pixels of the figure for one of the image
  // Of a point of the image in the figure.
  double x_px(const contract::ImagePoint& point) const { return left_px + zoom * (point.x_px + 0.5); }
  double y_px(const contract::ImagePoint& point) const { return top_px + zoom * (point.y_px + 0.5); }
};
struct PairLayout {
  int width_px = 0;
  int height_px = 0;
  ImagePlace u;
  ImagePlace v;
};
PairLayout layout_pair(const FigureImage& u, const FigureImage& v);

// The figure as a file. Each match has a colour of its own, unlike those of the lines above and below it, and a dot at
// either end. The same pixels every time (text: with the same fonts). Throws std::runtime_error for an image that
// cannot be decoded or does not have the size that the map has it in.
std::string pair_png(const PairFigure& figure);
std::string pair_svg(const PairFigure& figure);

}  // namespace mapweld::drawing
