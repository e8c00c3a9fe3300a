// Small photographs of invented places, made in milliseconds, and a vocabulary that fits them.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "core/vocabulary/vocabulary.h"

namespace mapweld::test {

// A textured wall, seen by a camera that moves along it: step `step` shows the 320x240 window that begins at
// step * 200 px, step < 12. Neighbouring steps share a third of their pixels, others nothing; nor do walls.
cv::Mat photo(std::uint64_t wall, int step);

// Nothing to see: one grey.
cv::Mat blank(int width_px = 320, int height_px = 240);

std::string jpeg(const cv::Mat& image);
std::string png(const cv::Mat& image);

// JPEG bytes of photo(wall, step).
std::string photo_jpeg(std::uint64_t wall, int step);

// 512 words made from the features of some walls; quantises exactly. The same object for the whole process.
const Vocabulary& small_vocabulary();

}  // namespace mapweld::test
