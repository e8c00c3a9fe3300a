#include "server/evaluation/contact_sheet.h"

#include <algorithm>
#include <stdexcept>

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

namespace mapweld::server::evaluation {
namespace {

constexpr int kWidth = 320, kHeight = 240;  // of an image
constexpr int kCaption = 22, kGap = 4, kMargin = 10;
constexpr int kPairsInRow = 2;
constexpr int kPairWidth = 2 * kWidth + kGap, kPairHeight = kHeight + kCaption;

// The image, as large as fits, in the middle of `frame`.
void draw(const std::vector<std::uint8_t>& bytes, cv::Mat frame) {
  frame.setTo(cv::Scalar::all(225));
  if (bytes.empty()) return;
  const cv::Mat image = cv::imdecode(bytes, cv::IMREAD_COLOR);
  if (image.empty()) throw std::runtime_error("a stored image cannot be decoded");
  const double scale =
      std::min(static_cast<double>(frame.cols) / image.cols, static_cast<double>(frame.rows) / image.rows);
  cv::Mat scaled;
  cv::resize(
      image, scaled,
      cv::Size(std::max(1, static_cast<int>(image.cols * scale)), std::max(1, static_cast<int>(image.rows * scale))), 0,
      0, scale < 1 ? cv::INTER_AREA : cv::INTER_LINEAR);
  scaled.copyTo(
      frame(cv::Rect((frame.cols - scaled.cols) / 2, (frame.rows - scaled.rows) / 2, scaled.cols, scaled.rows)));
}

}  // namespace

std::vector<std::uint8_t> contact_sheet(std::span<const SheetPair> pairs) {
  const int count = static_cast<int>(pairs.size());
  const int rows = std::max(1, (count + kPairsInRow - 1) / kPairsInRow);
  const int columns = std::clamp(count, 1, kPairsInRow);
  cv::Mat sheet(kMargin + rows * (kPairHeight + kMargin), kMargin + columns * (kPairWidth + kMargin), CV_8UC3,
                cv::Scalar::all(255));
  for (int i = 0; i < count; ++i) {
    const int x = kMargin + (i % kPairsInRow) * (kPairWidth + kMargin);
    const int y = kMargin + (i / kPairsInRow) * (kPairHeight + kMargin);
    const SheetPair& pair = pairs[static_cast<std::size_t>(i)];
    draw(pair.left, sheet(cv::Rect(x, y, kWidth, kHeight)));
    draw(pair.right, sheet(cv::Rect(x + kWidth + kGap, y, kWidth, kHeight)));
    cv::putText(sheet, pair.caption, cv::Point(x, y + kHeight + 15), cv::FONT_HERSHEY_SIMPLEX, 0.4,
                cv::Scalar(40, 35, 31), 1, cv::LINE_AA);
  }
  std::vector<std::uint8_t> png;
  if (!cv::imencode(".png", sheet, png)) throw std::runtime_error("a contact sheet cannot be encoded");
  return png;
}

}  // namespace mapweld::server::evaluation
