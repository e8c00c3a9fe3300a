// Which pixels of an image show something of the place: those that are not transparent, and those that a map's mask
// leaves (the robot's own body, a logo, the black corners of a lens).
#pragma once

#include <opencv2/core/mat.hpp>

#include "core/feature/decode.h"

namespace mapweld {

// A mask from a PNG file that was decoded without stretching: CV_8UC1, 255 where a pixel is used, 0 elsewhere. Used is
// what is at least half as bright as the file's brightest pixel (so 0 and 1 are as good as black and white) and not
// wholly transparent. Throws ImageError: unsupported_image (no PNG), empty_mask (nothing is used).
cv::Mat mask_of(const DecodedImage& image);

// What both leave of an image of `size`; empty when that is all of it. `used`: of the image's size, or empty; `mask`:
// of any size, scaled to the image's by the nearest pixel, or empty.
cv::Mat combined_masks(const cv::Mat& used, const cv::Mat& mask, cv::Size size);

// The image with the unused pixels replaced by what the used ones around them go over into: smooth, so that the border
// of the mask makes no edge. Both CV_8UC1 of one size; at least one pixel is used.
cv::Mat fill_unused(const cv::Mat& grey, const cv::Mat& used);

}  // namespace mapweld
