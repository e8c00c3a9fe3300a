#include "core/feature/contrast.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include <opencv2/imgproc.hpp>

namespace mapweld {
namespace {

constexpr double kLowPercentile = 0.005;
constexpr double kHighPercentile = 0.995;
// A border is what reaches from the frame with values that are black or white but for so much of the picture's range,
// and takes up so much of the frame; compression blurs it by so much.
constexpr double kBorderShareOfRange = 0.02;
constexpr double kBorderShareOfFrame = 0.05;
constexpr int kBorderBlur_px = 4;
// A picture is judged by its range without the border only when so much of it is left.
constexpr double kFewestPixels = 0.1;

double units_per_level(const cv::Mat& grey) { return grey.depth() == CV_16U ? 257 : 1; }

template <typename Pixel, typename Visit>
void visit_used(const cv::Mat& grey, const cv::Mat& used, const Visit& visit) {
  for (int y = 0; y < grey.rows; ++y) {
    const Pixel* row = grey.ptr<Pixel>(y);
    const std::uint8_t* counts = used.empty() ? nullptr : used.ptr(y);
    for (int x = 0; x < grey.cols; ++x) {
      if (counts == nullptr || counts[x] != 0) visit(row[x]);
    }
  }
}

// How often each value stands in the used pixels.
std::vector<std::int64_t> histogram_of(const cv::Mat& grey, const cv::Mat& used) {
  std::vector<std::int64_t> histogram(grey.depth() == CV_16U ? 65536 : 256);
  const auto count = [&](std::uint16_t value) { ++histogram[value]; };
  if (grey.depth() == CV_16U) {
    visit_used<std::uint16_t>(grey, used, count);
  } else {
    visit_used<std::uint8_t>(grey, used, count);
  }
  return histogram;
}

// In units of the picture.
struct ValueRange {
  std::int64_t pixels = 0;
  double low = 0;
  double high = 0;
  double width() const { return high - low; }
};

ValueRange robust_range(const cv::Mat& grey, const cv::Mat& used) {
  const std::vector<std::int64_t> histogram = histogram_of(grey, used);
  ValueRange range;
  for (const std::int64_t count : histogram) range.pixels += count;
  const auto percentile = [&](double share) {
    const auto rank = static_cast<std::int64_t>(share * static_cast<double>(range.pixels));
    std::int64_t below = 0;
    std::size_t value = 0;
    while (value + 1 < histogram.size() && (below += histogram[value]) <= rank) ++value;
    return static_cast<double>(value);
  };
  range.low = percentile(kLowPercentile);
  range.high = percentile(kHighPercentile);
  return range;
}

// Black or white: at most so far from either end of the scale, in units of the picture.
cv::Mat extremes_of(const cv::Mat& grey, double nearness) {
  return (grey <= nearness) | (grey >= 255 * units_per_level(grey) - nearness);
}

// 255 where a pixel is used and not of a border, 0 elsewhere; empty when there is no border.
cv::Mat without_border(const cv::Mat& grey, const cv::Mat& used, const ValueRange& range) {
  const double nearness = std::floor(kBorderShareOfRange * range.width());
  int in_frame = 0;
  for (const cv::Mat& side : {grey.row(0), grey.row(grey.rows - 1), grey.col(0), grey.col(grey.cols - 1)}) {
    in_frame += cv::countNonZero(extremes_of(side, nearness));
  }
  if (in_frame < kBorderShareOfFrame * 2 * (grey.cols + grey.rows)) return {};

  cv::Mat framed;
  cv::copyMakeBorder(extremes_of(grey, nearness), framed, 1, 1, 1, 1, cv::BORDER_CONSTANT, cv::Scalar(255));
  cv::floodFill(framed, {0, 0}, cv::Scalar(1), nullptr, {}, {}, 8);
  cv::Mat kept = framed({1, 1, grey.cols, grey.rows}) != 1;
  cv::erode(kept, kept, cv::Mat(), {-1, -1}, kBorderBlur_px);
  if (!used.empty()) kept &= used;
  return kept;
}

// Standard deviation of the pixels' own noise (Immerkaer 1996), by the median so that the picture's texture counts
// little. In units of the picture.
double noise_of(const cv::Mat& grey, const cv::Mat& used) {
  const cv::Mat difference = (cv::Mat_<float>(3, 3) << 1, -2, 1, -2, 4, -2, 1, -2, 1);
  cv::Mat response;
  cv::filter2D(grey, response, CV_32F, difference);
  std::vector<float> sizes;
  sizes.reserve(grey.total());
  visit_used<float>(response, used, [&](float value) { sizes.push_back(std::abs(value)); });
  if (sizes.empty()) return 0;
  const auto middle = sizes.begin() + static_cast<std::ptrdiff_t>(sizes.size() / 2);
  std::nth_element(sizes.begin(), middle, sizes.end());
  constexpr double kGainOfFilter = 6;             // root of the sum of its squares
  constexpr double kMedianOfDeviations = 0.6745;  // of a normal distribution
  return *middle / (kGainOfFilter * kMedianOfDeviations);
}

// Levels that a range of so many levels becomes, noise aside.
double wanted_range(double levels, const ContrastOptions& options) {
  const double step = (levels - options.narrow_range) / (options.ordinary_range - options.narrow_range);
  const double ordinary = std::clamp(step, 0.0, 1.0);
  return options.stretched_range + ordinary * (options.ordinary_range - options.stretched_range);
}

template <typename Pixel>
cv::Mat looked_up(const cv::Mat& grey, const std::vector<std::uint8_t>& table) {
  cv::Mat out(grey.size(), CV_8UC1);
  for (int y = 0; y < grey.rows; ++y) {
    const Pixel* from = grey.ptr<Pixel>(y);
    std::uint8_t* to = out.ptr(y);
    for (int x = 0; x < grey.cols; ++x) to[x] = table[from[x]];
  }
  return out;
}

cv::Mat looked_up(const cv::Mat& grey, const std::vector<std::uint8_t>& table) {
  return grey.depth() == CV_16U ? looked_up<std::uint16_t>(grey, table) : looked_up<std::uint8_t>(grey, table);
}

// `gain` levels a unit, the middle of the range in the middle of the levels.
cv::Mat stretched(const cv::Mat& grey, const ValueRange& range, double gain) {
  std::vector<std::uint8_t> table(grey.depth() == CV_16U ? 65536 : 256);
  const double middle = (range.low + range.high) / 2;
  for (std::size_t value = 0; value < table.size(); ++value) {
    const double level = std::floor(127.5 + (static_cast<double>(value) - middle) * gain + 0.5);
    table[value] = static_cast<std::uint8_t>(std::clamp(level, 0.0, 255.0));
  }
  return looked_up(grey, table);
}

}  // namespace

cv::Mat scaled_to_8_bits(const cv::Mat& grey) {
  if (grey.depth() != CV_16U) return grey;
  std::vector<std::uint8_t> table(65536);
  for (std::size_t value = 0; value < table.size(); ++value)
    table[value] = static_cast<std::uint8_t>((value + 128) / 257);
  return looked_up(grey, table);
}

cv::Mat stretched_to_8_bits(const cv::Mat& grey, const cv::Mat& used, const ContrastOptions& options) {
  const double unit = units_per_level(grey);
  cv::Mat counted = used;
  ValueRange range = robust_range(grey, counted);
  const cv::Mat inside = without_border(grey, used, range);
  if (!inside.empty()) {
    const ValueRange of_inside = robust_range(grey, inside);
    if (static_cast<double>(of_inside.pixels) >= kFewestPixels * static_cast<double>(range.pixels)) {
      range = of_inside;
      counted = inside;
    }
  }
  const double levels = range.width() / unit;
  if (levels >= options.ordinary_range || range.width() <= 0) return scaled_to_8_bits(grey);

  const double noise = noise_of(grey, counted);
  const double noise_of_rounding = 1.0 / 12;
  const double most = options.max_noise / std::sqrt(noise * noise + noise_of_rounding);
  const double gain = std::min(wanted_range(levels, options) / range.width(), most);
  return gain * unit <= 1 ? scaled_to_8_bits(grey) : stretched(grey, range, gain);
}

}  // namespace mapweld
