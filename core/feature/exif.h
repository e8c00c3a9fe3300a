// The one EXIF field that matters here: how the camera was held.
#pragma once

#include <cstdint>
#include <span>

#include <opencv2/core/mat.hpp>

namespace mapweld {

// EXIF orientation, 1..8, of a TIFF structure (the payload of a JPEG's APP1 after "Exif\0\0", or of a PNG's eXIf).
// 1, as stored, when the field is absent, out of range or the structure is broken: a bad tag spoils no good image.
int read_exif_orientation(std::span<const std::uint8_t> tiff);

// The picture as it is seen: an orientation names where row 0 and column 0 of the `stored` one lie in the scene.
cv::Mat upright(const cv::Mat& stored, int orientation);

}  // namespace mapweld
