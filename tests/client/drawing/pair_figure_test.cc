// Two images side by side: read back by another library than the one that drew it.
#include "client/drawing/pair_figure.h"

#include <cmath>
#include <stdexcept>

#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "client/drawing/picture.h"
#include "tests/client/drawing/well_formed.h"
#include "tests/core/feature/image_files.h"

namespace mapweld::drawing {
namespace {

using mapweld::testing::count_elements;
using mapweld::testing::xml_fault;

std::string file_of(const test::Bytes& bytes) { return {bytes.begin(), bytes.end()}; }

cv::Mat read_png(const std::string& bytes) {
  return cv::imdecode(std::vector<std::uint8_t>(bytes.begin(), bytes.end()), cv::IMREAD_COLOR);
}

// Grey photographs: every colour in the figure's images is of a match.
cv::Mat grey_image(int width, int height, std::uint64_t seed) {
  cv::Mat grey;
  cv::cvtColor(test::textured_image(width, height, seed), grey, cv::COLOR_BGR2GRAY);
  cv::Mat image;
  cv::cvtColor(grey, image, cv::COLOR_GRAY2BGR);
  return image;
}

FigureImage figure_image(const cv::Mat& image, const std::string& caption) {
  return {file_of(test::encode(".png", image)), image.cols, image.rows, caption};
}

cv::Vec3b pixel(const cv::Mat& image, double x, double y) {
  return image.at<cv::Vec3b>(static_cast<int>(std::floor(y)), static_cast<int>(std::floor(x)));
}
int colourfulness(const cv::Vec3b& p) { return std::max({p[0], p[1], p[2]}) - std::min({p[0], p[1], p[2]}); }

PairFigure figure() {
  PairFigure figure;
  figure.title = "accepted: 24 inliers of 41 matches";
  figure.subtitle = "Merge 1";
  figure.u = figure_image(grey_image(320, 240, 1), "000.jpg of lab-a");
  figure.v = figure_image(grey_image(160, 200, 2), "001.jpg of lab-b");
  figure.matches = {{{30, 40}, {20, 30}}, {{200.5, 60.25}, {100, 50}}, {{300, 200}, {140, 180}}, {{10, 230}, {5, 190}}};
  return figure;
}

TEST(PairFigure, ShowsBothImagesWhereTheLayoutSays) {
  PairFigure plain = figure();
  plain.matches.clear();
  const PairLayout layout = layout_pair(plain.u, plain.v);
  EXPECT_EQ(layout.u.zoom, 2);
  const cv::Mat png = read_png(pair_png(plain));
  ASSERT_EQ(png.cols, layout.width_px);
  ASSERT_EQ(png.rows, layout.height_px);
  EXPECT_GE(png.cols, 2 * 320 + 2 * 160);
  EXPECT_GE(png.rows, 2 * 240);
  const cv::Mat u = grey_image(320, 240, 1), v = grey_image(160, 200, 2);
  for (const auto& [image, place] : {std::pair(u, layout.u), std::pair(v, layout.v)}) {
    // Enlarged by interpolation: the mean of a patch stays.
    for (const cv::Rect patch :
         {cv::Rect(0, 0, 12, 12), cv::Rect(90, 100, 12, 12), cv::Rect(image.cols - 12, 8, 12, 12)}) {
      const cv::Rect there(static_cast<int>(place.left_px + 2 * patch.x), static_cast<int>(place.top_px + 2 * patch.y),
                           24, 24);
      EXPECT_NEAR(cv::mean(png(there))[0], cv::mean(image(patch))[0], 6);
    }
  }
  EXPECT_EQ(pixel(png, 3, 3), cv::Vec3b(255, 255, 255));
  // Title and captions: ink above the images, none of it beside them.
  EXPECT_LT(cv::mean(png(cv::Rect(20, 18, 200, 20)))[0], 250);
  EXPECT_LT(cv::mean(png(cv::Rect(static_cast<int>(layout.v.left_px), 74, 60, 14)))[0], 250);
}

TEST(PairFigure, LinesEndAtTheMatchesEachInOneColour) {
  const PairFigure drawn = figure();
  const PairLayout layout = layout_pair(drawn.u, drawn.v);
  const cv::Mat png = read_png(pair_png(drawn));
  std::vector<cv::Vec3b> colours;
  for (const contract::PointMatch& match : drawn.matches) {
    const double u_x = layout.u.left_px + 2 * (match.u.x_px + 0.5), u_y = layout.u.top_px + 2 * (match.u.y_px + 0.5);
    const double v_x = layout.v.left_px + 2 * (match.v.x_px + 0.5), v_y = layout.v.top_px + 2 * (match.v.y_px + 0.5);
    const cv::Vec3b at_u = pixel(png, u_x, u_y), at_v = pixel(png, v_x, v_y);
    EXPECT_EQ(at_u, at_v);
    EXPECT_GT(colourfulness(at_u), 150);
    for (const cv::Vec3b& other : colours) EXPECT_GT(cv::norm(at_u, other), 60);
    colours.push_back(at_u);
    // A line in between: some pixel across its middle has the colour's tint, thinly.
    const double middle_x = (u_x + v_x) / 2, middle_y = (u_y + v_y) / 2;
    int coloured = 0;
    for (int dy = -6; dy <= 6; ++dy) coloured += colourfulness(pixel(png, middle_x, middle_y + dy)) > 60 ? 1 : 0;
    EXPECT_GE(coloured, 1);
    EXPECT_LE(coloured, 4);
    // And none beyond the dot.
    EXPECT_LT(colourfulness(pixel(png, u_x - 8, u_y)), 40);
  }
}

TEST(PairFigure, ReducesLargeImagesAndTakesSmallOnes) {
  PairFigure large = figure();
  large.u = figure_image(grey_image(2400, 1200, 3), std::string(400, 'm'));
  large.v = figure_image(grey_image(1, 1, 4), "");
  large.title = "\xC3\xBC" + std::string(300, 'W');
  large.matches = {{{2399, 1199}, {0, 0}}};
  const PairLayout layout = layout_pair(large.u, large.v);
  const cv::Mat png = read_png(pair_png(large));
  ASSERT_EQ(png.cols, layout.width_px);
  EXPECT_LE(png.cols, 2 * 800 + 60);
  EXPECT_GT(colourfulness(pixel(png, layout.u.x_px({2399, 1199}), layout.u.y_px({2399, 1199}))), 150);
  // The texts are cut to their width.
  for (int y = 0; y < 90; ++y) EXPECT_EQ(pixel(png, png.cols - 4, y), cv::Vec3b(255, 255, 255));
}

TEST(PairFigure, IsAWellFormedSvgToo) {
  const std::string svg = pair_svg(figure());
  EXPECT_EQ(xml_fault(svg), "");
  EXPECT_EQ(count_elements(svg, "image"), 2U);
  EXPECT_NE(svg.find("data:image/png;base64,"), std::string::npos);
  const PairLayout layout = layout_pair(figure().u, figure().v);
  EXPECT_NE(svg.find("width=\"" + std::to_string(layout.width_px) + "px\""), std::string::npos) << svg.substr(0, 300);
}

TEST(PairFigure, IsTheSameEveryTime) { EXPECT_TRUE(pair_png(figure()) == pair_png(figure())); }

TEST(PairFigure, RefusesWhatItCannotShow) {
  PairFigure broken = figure();
  broken.u.bytes = "not an image";
  EXPECT_THROW(pair_png(broken), std::runtime_error);
  broken.u.bytes = "";
  EXPECT_THROW(pair_png(broken), std::runtime_error);
  broken.u.bytes = figure().u.bytes.substr(0, 20);
  EXPECT_THROW(pair_svg(broken), std::runtime_error);
  broken = figure();
  broken.v.width_px = 200;  // the lines would end elsewhere
  EXPECT_THROW(pair_png(broken), std::runtime_error);
}

TEST(DecodePicture, TakesWhatTheServerTakes) {
  const cv::Mat image = grey_image(64, 48, 5);
  cv::Mat alpha, deep;
  cv::cvtColor(image, alpha, cv::COLOR_BGR2BGRA);
  image.convertTo(deep, CV_16U, 257);
  cv::Mat grey;
  cv::cvtColor(image, grey, cv::COLOR_BGR2GRAY);
  for (const test::Bytes& bytes :
       {test::encode(".png", image), test::encode(".jpg", image), test::encode(".png", alpha),
        test::encode(".png", deep), test::encode(".png", grey), test::encode(".jpg", grey),
        test::encode_jpeg(image, {.colours = test::JpegColours::kCmyk})}) {
    const Picture picture = decode_picture(file_of(bytes));
    ASSERT_EQ(width_px(picture), 64);
    ASSERT_EQ(height_px(picture), 48);
    const cv::Mat pixels(48, 64, CV_8UC4, cairo_image_surface_get_data(picture.get()),
                         static_cast<std::size_t>(cairo_image_surface_get_stride(picture.get())));
    cv::Mat read;
    cv::cvtColor(pixels, read, cv::COLOR_BGRA2BGR);
    EXPECT_LT(cv::norm(read, image, cv::NORM_L1) / (64 * 48 * 3), 4);
  }
}

// The matches are in pixels of the upright image: it is to be shown upright.
TEST(DecodePicture, TurnsAPhotographUpright) {
  cv::Mat image(40, 60, CV_8UC3, cv::Scalar(0, 0, 0));
  image(cv::Rect(0, 0, 30, 20)).setTo(cv::Scalar(255, 255, 255));  // upper left
  const test::Bytes jpeg = test::encode(".jpg", image);
  // Where the white quarter comes to lie, by EXIF: 6 is turned clockwise, 3 by half.
  struct Turned {
    int orientation;
    int width, height;
    int white_x, white_y;
  };
  for (const Turned& t :
       {Turned{1, 60, 40, 10, 10}, Turned{3, 60, 40, 50, 30}, Turned{6, 40, 60, 30, 10}, Turned{8, 40, 60, 10, 50}}) {
    const Picture picture = decode_picture(file_of(test::with_jpeg_exif(jpeg, test::exif_block(t.orientation, true))));
    EXPECT_EQ(width_px(picture), t.width) << t.orientation;
    EXPECT_EQ(height_px(picture), t.height) << t.orientation;
    const auto* row = reinterpret_cast<const std::uint32_t*>(cairo_image_surface_get_data(picture.get()) +
                                                             static_cast<std::ptrdiff_t>(t.white_y) *
                                                                 cairo_image_surface_get_stride(picture.get()));
    EXPECT_GT(row[t.white_x] & 0xFFU, 200U) << t.orientation;
    EXPECT_LT(row[t.width - 1 - t.white_x] & 0xFFU, 50U) << t.orientation;
  }
}

}  // namespace
}  // namespace mapweld::drawing
