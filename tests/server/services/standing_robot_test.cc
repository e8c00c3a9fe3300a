// A robot that stands still in a dim place, uploaded frame by frame (docs/pictures.md).
#include <cstdint>
#include <string>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "server/services/image_service.h"
#include "tests/server/support/services_under_test.h"
#include "tests/server/support/test_photos.h"

namespace mapweld::test {
namespace {

using server::UploadOutcome;

// The robot waits in the dark: every frame has noise of its own, and no two have as many features as max_inliers.
cv::Mat dim_frame(int pixels_aside, std::uint64_t seed) {
  const cv::Mat wall = photo(3, 0);
  cv::Mat frame(wall.size(), wall.type(), cv::Scalar(40, 40, 40));
  const cv::Rect lit(70 + pixels_aside, 45, 170, 150);  // a window in a dark wall
  cv::Mat dimmed;
  wall({40, 30, 170, 150}).convertTo(dimmed, CV_8UC3, 0.3, 35);
  dimmed.copyTo(frame(lit));
  cv::RNG random(seed);
  cv::Mat noise(frame.size(), CV_16SC3);
  random.fill(noise, cv::RNG::NORMAL, 0, 1.5);
  cv::add(frame, noise, frame, cv::noArray(), CV_8U);
  return frame;
}

TEST(StandingRobot, MakesOneVertex) {
  ServicesUnderTest services;
  services.create_map("lab");
  for (std::uint64_t i = 0; i < 20; ++i) {
    const UploadOutcome outcome = services.upload("lab", std::to_string(i), jpeg(dim_frame(0, i + 1)));
    EXPECT_LT(outcome.upload.features, 200);
    if (i == 0) continue;
    EXPECT_EQ(outcome.upload.outcome, "ignored") << i;
    EXPECT_EQ(outcome.upload.reason, "too_similar");
    EXPECT_LE(outcome.upload.inliers, 200);
  }
  EXPECT_EQ(services.maps().get("lab").vertices, 1);
}

TEST(StandingRobot, ThatMovesSlowlyIsNotThinned) {
  ServicesUnderTest services;
  services.create_map("lab");
  for (int i = 0; i < 10; ++i) {
    const auto outcome =
        services.upload("lab", std::to_string(i), jpeg(dim_frame(2 * i, 77 + static_cast<std::uint64_t>(i))));
    EXPECT_EQ(outcome.upload.outcome, "inserted") << i;
    EXPECT_EQ(outcome.upload.edges->empty(), i == 0);
  }
}

TEST(StandingRobot, IsKeptWholeWhereMaxInliersHasNoLimit) {
  ServicesUnderTest services;
  contract::CreateMap request;
  request.name = "lab";
  request.parameters.emplace();
  request.parameters->max_inliers = 65535;
  services.maps().create(request);
  for (std::uint64_t i = 0; i < 4; ++i) {
    EXPECT_TRUE(services.upload("lab", std::to_string(i), jpeg(dim_frame(0, i + 1))).created);
  }
}

}  // namespace
}  // namespace mapweld::test
