// Grey pictures of any depth brought to the 8 bits that SIFT takes.
//
// SIFT finds what stands out by a fixed contrast (its threshold is some 3 of 255 levels). A thermal camera writes 500
// of 65,536 levels, a 12-bit camera a sixteenth of them, a camera behind a dirty window an eighth: all plain pictures
// in which nothing stands out so far. Their range is stretched before anything is lost to 8 bits.
#pragma once

#include <opencv2/core/mat.hpp>

namespace mapweld {

// Lengths in levels of an 8-bit picture, however many bits the picture has (65,535 is 255). Ranges are robust: between
// the percentiles 0.5 and 99.5, so that hot and dead pixels do not count, and without a border that a lens, a
// rectification or a letterbox left black or white.
struct ContrastOptions {
  // A picture whose range is at least so wide is left as it is, bit for bit. Of 5,517 photographs of homes, offices,
  // corridors, towers and a museum, 32 have less: bare or dim walls but for one, with 11 to 79.
  double ordinary_range = 80;
  // One with at most so much is stretched to `stretched_range`, what ordinary photographs have; between the two it
  // passes from the one to the other without a step.
  double narrow_range = 48;
  double stretched_range = 224;
  // Noise (that of the pixels, and that of a source of few levels) is not raised above so much: a covered lens stays
  // blank.
  double max_noise = 4;
};

// CV_8UC1 of a CV_8UC1 or CV_16UC1 picture, stretched where its range is narrow. `used`: CV_8UC1 of the same size, 0
// where a pixel does not count; empty: all do. Deterministic.
cv::Mat stretched_to_8_bits(const cv::Mat& grey, const cv::Mat& used = {}, const ContrastOptions& options = {});

// Only scaled: 16 bits to 8, rounded; 8 bits as they are.
cv::Mat scaled_to_8_bits(const cv::Mat& grey);

}  // namespace mapweld
