// Pairs of images side by side, for judging by eye.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace mapweld::server::evaluation {

struct SheetPair {
  std::vector<std::uint8_t> left;  // JPEG or PNG bytes; empty: not kept, an empty frame is drawn
  std::vector<std::uint8_t> right;
  std::string caption;  // ASCII
};

// One PNG: the pairs row by row, two to a row, each image scaled into 320 x 240 px, the caption below. Throws
// std::runtime_error for bytes that are no image.
std::vector<std::uint8_t> contact_sheet(std::span<const SheetPair> pairs);

}  // namespace mapweld::server::evaluation
