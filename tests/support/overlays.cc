#include "tests/support/overlays.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include <opencv2/imgproc.hpp>

namespace mapweld::rendered {
namespace {

// Everything is drawn on a canvas of this size and laid over the frame, scaled.
constexpr int kWidth = 640;
constexpr int kHeight = 480;

struct Layer {
  cv::Mat bgr{kHeight, kWidth, CV_8UC3, cv::Scalar(0, 0, 0)};
  cv::Mat alpha{kHeight, kWidth, CV_32F, cv::Scalar(0)};  // 0: the frame, 1: the overlay
};

void lay_over(cv::Mat& frame, const Layer& layer) {
  cv::Mat colour, alpha;
  cv::resize(layer.bgr, colour, frame.size(), 0, 0, cv::INTER_AREA);
  cv::resize(layer.alpha, alpha, frame.size(), 0, 0, cv::INTER_AREA);
  for (int y = 0; y < frame.rows; ++y) {
    for (int x = 0; x < frame.cols; ++x) {
      const float a = alpha.at<float>(y, x);
      if (a <= 0) continue;
      auto& pixel = frame.at<cv::Vec3b>(y, x);
      const auto& over = colour.at<cv::Vec3b>(y, x);
      for (int c = 0; c < 3; ++c) pixel[c] = cv::saturate_cast<std::uint8_t>(a * over[c] + (1 - a) * pixel[c]);
    }
  }
}

void text(Layer& layer, const std::string& words, cv::Point at, double scale, const cv::Scalar& colour) {
  cv::putText(layer.bgr, words, at, cv::FONT_HERSHEY_SIMPLEX, scale, colour, 2, cv::LINE_AA);
  cv::putText(layer.alpha, words, at, cv::FONT_HERSHEY_SIMPLEX, scale, cv::Scalar(1), 2, cv::LINE_AA);
}

void panel(Layer& layer, const cv::Rect& where, const cv::Scalar& colour) {
  cv::rectangle(layer.bgr, where, colour, cv::FILLED);
  cv::rectangle(layer.alpha, where, cv::Scalar(1), cv::FILLED);
}

void stroke(Layer& layer, cv::Point from, cv::Point to, const cv::Scalar& colour, int width) {
  cv::line(layer.bgr, from, to, colour, width, cv::LINE_AA);
  cv::line(layer.alpha, from, to, cv::Scalar(1), width, cv::LINE_AA);
}

// Painted metal: plates of other greys with seams, bolts and lettering, all inside `area`.
void plates(cv::Mat& bgr, const cv::Rect& area, std::uint64_t seed) {
  cv::RNG random(seed);
  cv::Mat part = bgr(area);
  part.setTo(cv::Scalar(70, 74, 78));
  for (int i = 0; i < 14; ++i) {
    const cv::Rect plate(random.uniform(0, area.width - 30), random.uniform(0, area.height - 20),
                         random.uniform(24, 130), random.uniform(14, 50));
    const int grey = random.uniform(40, 190);
    cv::rectangle(part, plate, cv::Scalar(grey, grey, grey + random.uniform(0, 20)), cv::FILLED);
    cv::rectangle(part, plate, cv::Scalar(30, 30, 30), 1, cv::LINE_AA);
  }
  for (int i = 0; i < 26; ++i) {
    const cv::Point at(random.uniform(4, area.width - 4), random.uniform(4, area.height - 4));
    cv::circle(part, at, random.uniform(2, 5), cv::Scalar(20, 20, 20), cv::FILLED, cv::LINE_AA);
    cv::circle(part, at + cv::Point(-1, -1), 1, cv::Scalar(230, 230, 230), cv::FILLED, cv::LINE_AA);
  }
  cv::putText(part, "MW-7 DRIVE", {area.width / 6, area.height / 2}, cv::FONT_HERSHEY_DUPLEX, 0.7, {220, 220, 210}, 1,
              cv::LINE_AA);
}

// A soft bright patch that lies elsewhere in every frame.
void gleam(cv::Mat& bgr, const cv::Rect& area, int frame) {
  cv::RNG random(static_cast<std::uint64_t>(frame) + 17);
  cv::Mat patch(area.size(), CV_8UC3, cv::Scalar(0, 0, 0));
  for (int i = 0; i < 3; ++i) {
    cv::ellipse(patch, {random.uniform(0, area.width), random.uniform(0, area.height)},
                {random.uniform(20, 70), random.uniform(8, 26)}, random.uniform(0, 180), 0, 360,
                cv::Scalar::all(random.uniform(25, 60)), cv::FILLED);
  }
  cv::GaussianBlur(patch, patch, {}, 9);
  cv::Mat part = bgr(area);
  part += patch;
}

Layer camera_text() {
  Layer layer;
  text(layer, "REC  CAM 2  1280x960  F/1.8  ISO 200", {14, 28}, 0.65, {250, 250, 250});
  text(layer, "UNIT 4402-K   GAIN 6 dB   WB INDOOR", {14, kHeight - 16}, 0.65, {250, 250, 250});
  return layer;
}

Layer clock(int frame) {
  Layer layer;
  panel(layer, {kWidth - 300, 8, 290, 40}, {20, 20, 20});
  cv::rectangle(layer.bgr, {kWidth - 300, 8, 290, 40}, {200, 200, 200}, 2);
  char words[40];
  std::snprintf(words, sizeof(words), "2024-03-%02d %02d:%02d:%02d", 1 + frame / 97 % 28, 8 + frame / 60 % 12,
                frame * 7 % 60, frame * 13 % 60);
  text(layer, words, {kWidth - 288, 36}, 0.7, {90, 240, 250});
  return layer;
}

Layer body(int frame) {
  Layer layer;
  const cv::Rect hull(0, kHeight * 3 / 4, kWidth, kHeight / 4);
  plates(layer.bgr, hull, 91);
  gleam(layer.bgr, hull, frame);
  const std::vector<cv::Point> outline = {{0, kHeight},  {0, hull.y + 70},   {90, hull.y + 24},     {220, hull.y + 4},
                                          {420, hull.y}, {560, hull.y + 30}, {kWidth, hull.y + 80}, {kWidth, kHeight}};
  cv::fillPoly(layer.alpha, std::vector<std::vector<cv::Point>>{outline}, cv::Scalar(1), cv::LINE_AA);
  return layer;
}

Layer crosshair() {
  Layer layer;
  const cv::Scalar green(60, 255, 90);
  const cv::Point middle(kWidth / 2, kHeight / 2);
  stroke(layer, middle + cv::Point(-130, 0), middle + cv::Point(-16, 0), green, 2);
  stroke(layer, middle + cv::Point(16, 0), middle + cv::Point(130, 0), green, 2);
  stroke(layer, middle + cv::Point(0, -110), middle + cv::Point(0, -16), green, 2);
  stroke(layer, middle + cv::Point(0, 16), middle + cv::Point(0, 110), green, 2);
  for (int i = 1; i <= 6; ++i) {
    for (const int side : {-1, 1}) {
      const int half = i % 2 == 0 ? 9 : 5;
      stroke(layer, middle + cv::Point(side * 20 * i, -half), middle + cv::Point(side * 20 * i, half), green, 2);
      if (i < 6)
        stroke(layer, middle + cv::Point(-half, side * 20 * i), middle + cv::Point(half, side * 20 * i), green, 2);
    }
  }
  cv::circle(layer.bgr, middle, 60, green, 2, cv::LINE_AA);
  cv::circle(layer.alpha, middle, 60, cv::Scalar(1), 2, cv::LINE_AA);
  for (const int x : {40, kWidth - 40}) {
    for (const int y : {40, kHeight - 40}) {
      const int in_x = x < kWidth / 2 ? 1 : -1;
      const int in_y = y < kHeight / 2 ? 1 : -1;
      stroke(layer, {x, y}, {x + in_x * 46, y}, green, 3);
      stroke(layer, {x, y}, {x, y + in_y * 46}, green, 3);
    }
  }
  text(layer, "AZ", {middle.x + 140, middle.y + 6}, 0.5, green);
  text(layer, "EL", {middle.x - 10, middle.y - 118}, 0.5, green);
  return layer;
}

Layer wiper(int frame) {
  Layer layer;
  // Heating wires and a sticker are always there; the arm is parked in two frames of three.
  for (int y = 60; y < kHeight; y += 70) stroke(layer, {0, y}, {kWidth, y + 4}, {50, 50, 60}, 1);
  layer.alpha *= 0.5;
  panel(layer, {22, 18, 86, 66}, {190, 120, 40});
  text(layer, "TUV", {30, 46}, 0.7, {255, 255, 255});
  text(layer, "09 27", {30, 74}, 0.6, {255, 255, 255});
  const bool parked = frame % 3 != 2;
  const double angle = parked ? 0.10 : 0.75;
  const cv::Point pivot(kWidth - 60, kHeight - 8);
  const cv::Point tip(pivot.x - static_cast<int>(430 * std::cos(angle)),
                      pivot.y - static_cast<int>(430 * std::sin(angle)));
  const cv::Point half = (pivot + tip) / 2;
  stroke(layer, pivot, half, {25, 25, 25}, 14);
  stroke(layer, half, tip, {12, 12, 12}, 8);
  for (int i = 1; i < 8; ++i) {
    const cv::Point at = pivot + (tip - pivot) * i / 8;
    cv::circle(layer.bgr, at, 5, {150, 150, 150}, 2, cv::LINE_AA);
    cv::circle(layer.alpha, at, 5, cv::Scalar(1), 2, cv::LINE_AA);
  }
  cv::circle(layer.bgr, pivot, 20, {60, 60, 66}, cv::FILLED, cv::LINE_AA);
  cv::circle(layer.alpha, pivot, 20, cv::Scalar(1), cv::FILLED, cv::LINE_AA);
  cv::circle(layer.bgr, pivot, 8, {190, 190, 190}, 2, cv::LINE_AA);
  return layer;
}

Layer mirror(int frame) {
  Layer layer;
  const cv::Rect outer(kWidth / 2, 0, kWidth / 2, kHeight / 2);
  const cv::Rect glass(outer.x + 16, outer.y + 14, outer.width - 30, outer.height - 30);
  panel(layer, outer, {24, 24, 26});
  // In the glass: a view that is another in every frame, and the vehicle's own flank on the right.
  cv::RNG random(static_cast<std::uint64_t>(frame) * 7919 + 5);
  cv::Mat view = layer.bgr(glass);
  view.setTo(cv::Scalar::all(random.uniform(90, 150)));
  for (int i = 0; i < 18; ++i) {
    cv::rectangle(
        view,
        {random.uniform(0, glass.width), random.uniform(0, glass.height), random.uniform(8, 70), random.uniform(8, 60)},
        cv::Scalar::all(random.uniform(30, 220)), cv::FILLED);
  }
  cv::GaussianBlur(view, view, {}, 1.5);
  plates(layer.bgr, {glass.x + glass.width * 2 / 5, glass.y, glass.width * 3 / 5, glass.height}, 23);
  cv::putText(layer.bgr, "OBJECTS ARE CLOSER", {outer.x + 40, outer.y + outer.height - 5}, cv::FONT_HERSHEY_PLAIN, 1.1,
              {210, 210, 210}, 1, cv::LINE_AA);
  return layer;
}

Layer vignette() {
  Layer layer;
  const double reach = std::hypot(kWidth / 2.0, kHeight / 2.0);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const double r = std::hypot(x - kWidth / 2.0, y - kHeight / 2.0) / reach;
      layer.alpha.at<float>(y, x) = static_cast<float>(std::clamp((r - 0.72) / 0.1, 0.0, 1.0));
    }
  }
  cv::RNG random(4242);
  for (int i = 0; i < 34; ++i) {
    const cv::Point at(random.uniform(60, kWidth - 60), random.uniform(50, kHeight - 50));
    const int radius = random.uniform(2, 7);
    cv::circle(layer.alpha, at, radius, cv::Scalar(random.uniform(0.5, 0.9)), cv::FILLED, cv::LINE_AA);
  }
  for (int i = 0; i < 5; ++i) {
    const cv::Point at(random.uniform(80, kWidth - 80), random.uniform(80, kHeight - 80));
    cv::line(layer.alpha, at, at + cv::Point(random.uniform(-50, 50), random.uniform(-30, 30)), cv::Scalar(0.7), 2,
             cv::LINE_AA);
  }
  return layer;
}

Layer layer_of(Overlay overlay, int frame) {
  switch (overlay) {
    case Overlay::kText:
      return camera_text();
    case Overlay::kClock:
      return clock(frame);
    case Overlay::kBody:
      return body(frame);
    case Overlay::kCrosshair:
      return crosshair();
    case Overlay::kWiper:
      return wiper(frame);
    case Overlay::kMirror:
      return mirror(frame);
    case Overlay::kVignette:
      return vignette();
  }
  return {};
}

}  // namespace

std::string_view to_string(Overlay overlay) {
  switch (overlay) {
    case Overlay::kText:
      return "text";
    case Overlay::kClock:
      return "clock";
    case Overlay::kBody:
      return "body";
    case Overlay::kCrosshair:
      return "crosshair";
    case Overlay::kWiper:
      return "wiper";
    case Overlay::kMirror:
      return "mirror";
    case Overlay::kVignette:
      return "vignette";
  }
  return "";
}

void draw_overlay(cv::Mat& bgr, Overlay overlay, int frame) { lay_over(bgr, layer_of(overlay, frame)); }

cv::Mat covered_by(Overlay overlay, cv::Size size, int frame) {
  cv::Mat alpha;
  cv::resize(layer_of(overlay, frame).alpha, alpha, size, 0, 0, cv::INTER_AREA);
  return alpha > 0.08;
}

}  // namespace mapweld::rendered
