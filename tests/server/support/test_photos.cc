#include "tests/server/support/test_photos.h"

#include <map>
#include <mutex>
#include <random>

#include <opencv2/core/utility.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "core/feature/extractor.h"

// OpenCV's codecs drag in GDAL, which takes two locks of its own in either order when it starts.
extern "C" const char* __tsan_default_suppressions() { return "deadlock:libgdal.so\n"; }

namespace mapweld::test {
namespace {

constexpr int kStepPx = 200;
constexpr int kWidthPx = 320;
constexpr int kHeightPx = 240;
constexpr int kSteps = 12;

cv::Mat paint_wall(std::uint64_t wall) {
  std::mt19937_64 random(wall * 7919 + 1);
  const auto below = [&](int bound) { return static_cast<int>(random() % static_cast<std::uint64_t>(bound)); };
  cv::Mat image(kHeightPx, kWidthPx + kSteps * kStepPx, CV_8UC3, cv::Scalar(128, 128, 128));
  for (int i = 0; i < 2200; ++i) {
    const cv::Point at(below(image.cols), below(image.rows));
    const cv::Scalar colour(below(256), below(256), below(256));
    if (i % 3 == 0) {
      cv::circle(image, at, 3 + below(12), colour, cv::FILLED);
    } else {
      cv::rectangle(image, at, at + cv::Point(4 + below(26), 4 + below(26)), colour, cv::FILLED);
    }
  }
  cv::GaussianBlur(image, image, cv::Size(3, 3), 0.8);
  return image;
}

// As the server does: one image a thread, none of OpenCV's own.
const bool kOneThread = [] {
  cv::setNumThreads(0);
  return true;
}();

std::string encode(const std::string& extension, const cv::Mat& image) {
  std::vector<std::uint8_t> bytes;
  cv::imencode(extension, image, bytes);
  return {bytes.begin(), bytes.end()};
}

}  // namespace

cv::Mat photo(std::uint64_t wall, int step) {
  static std::mutex mutex;
  static std::map<std::uint64_t, cv::Mat> walls;
  const std::lock_guard lock(mutex);
  cv::Mat& painted = walls[wall];
  if (painted.empty()) painted = paint_wall(wall);
  return painted(cv::Rect(step * kStepPx, 0, kWidthPx, kHeightPx)).clone();
}

cv::Mat blank(int width_px, int height_px) { return {height_px, width_px, CV_8UC3, cv::Scalar(90, 90, 90)}; }

std::string jpeg(const cv::Mat& image) { return encode(".jpg", image); }
std::string png(const cv::Mat& image) { return encode(".png", image); }
std::string photo_jpeg(std::uint64_t wall, int step) { return jpeg(photo(wall, step)); }

const Vocabulary& small_vocabulary() {
  static const Vocabulary vocabulary = [] {
    constexpr std::size_t kWords = 512;
    std::vector<std::uint8_t> centroids;
    for (std::uint64_t wall = 1000; centroids.size() < kWords * kDescriptorDimension; ++wall) {
      cv::Mat grey;
      cv::cvtColor(photo(wall, 0), grey, cv::COLOR_BGR2GRAY);
      const Features features = extract_features(grey, {.max_features = 128});
      centroids.insert(centroids.end(), features.descriptors.begin(), features.descriptors.end());
    }
    centroids.resize(kWords * kDescriptorDimension);
    WordIndexOptions options;
    options.engine = "exact";
    return Vocabulary(std::move(centroids), options);
  }();
  return vocabulary;
}

}  // namespace mapweld::test
