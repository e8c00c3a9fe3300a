// From samples of light to the bytes that a camera delivers.
#pragma once

#include <cstdint>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "tests/support/rendered_world.h"

namespace mapweld::rendered {

// Averages `oversampling` x `oversampling` samples (0x..RRGGBB) a pixel, with motion blur across, then applies
// vignetting, exposure, gamma, warmth and noise. Integers and tables: the same on every machine.
cv::Mat expose(const std::vector<std::uint32_t>& samples, int width_px, int height_px, int oversampling,
               const CameraConditions& conditions);

}  // namespace mapweld::rendered
