// Things that are in every picture of a camera: drawn over frames that are without.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

#include <opencv2/core/mat.hpp>

namespace mapweld::rendered {

enum class Overlay : std::uint8_t {
  kText,       // two lines of the camera's own text
  kClock,      // date and time on a panel, other digits in every frame
  kBody,       // the robot's hull in the lowest quarter, with bolts, plates and a moving gleam
  kCrosshair,  // a reticle with scales, and brackets in the corners
  kWiper,      // an arm with its blade, parked low or half way up, behind a heated pane with its sticker
  kMirror,    // a mirror that fills the upper right quarter: a frame, in it part of the vehicle and a view that changes
  kVignette,  // dark corners, dust and scratches
};

inline constexpr std::array kOverlays = {Overlay::kText,  Overlay::kClock,  Overlay::kBody,    Overlay::kCrosshair,
                                         Overlay::kWiper, Overlay::kMirror, Overlay::kVignette};

std::string_view to_string(Overlay overlay);

// Draws the overlay over a frame (CV_8UC3) as it looks in frame number `frame`. What is fixed lies at the same share of
// width and height in frames of any size. The same pixels for the same arguments.
void draw_overlay(cv::Mat& bgr, Overlay overlay, int frame);

// Which pixels of a frame of this size it covers, wholly or in part: CV_8U, 255 or 0.
cv::Mat covered_by(Overlay overlay, cv::Size size, int frame);

}  // namespace mapweld::rendered
