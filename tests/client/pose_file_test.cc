#include "client/pose_file.h"

#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <system_error>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace mapweld::client {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

class PoseFile : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::path(testing::TempDir()) /
              ("poses-" + std::string(testing::UnitTest::GetInstance()->current_test_info()->name()));
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }
  fs::path file(const std::string& text) const {
    const fs::path path = folder_ / "file";
    std::ofstream(path) << text;
    return path;
  }
  std::string wrong_with(const std::string& text) const {
    try {
      read_poses(file(text), "world");
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "";
  }
  fs::path folder_;
};

TEST_F(PoseFile, ALineIsAPose) {
  // A quarter turn about z, and half a turn about x.
  const auto poses = read_poses(file("# timestamp tx ty tz qx qy qz qw\n"
                                     "1305031102.1753 1 2 3 0 0 0.70710678 0.70710678\n\n"
                                     "b.jpg -1 0 0.5 1 0 0 0\n"),
                                "lab");
  ASSERT_EQ(poses.size(), 2U);
  const contract::Pose* first = find_pose(poses, "1305031102.1753.png");
  ASSERT_NE(first, nullptr);
  EXPECT_EQ(first->frame, "lab");
  const std::vector<std::vector<double>> expected = {{0, -1, 0, 1}, {1, 0, 0, 2}, {0, 0, 1, 3}, {0, 0, 0, 1}};
  for (std::size_t r = 0; r < 4; ++r) {
    for (std::size_t k = 0; k < 4; ++k) EXPECT_NEAR(first->matrix_4x4[r][k], expected[r][k], 1e-7) << r << k;
  }
  const contract::Pose* second = find_pose(poses, "b.jpg");
  ASSERT_NE(second, nullptr);
  EXPECT_EQ(second->matrix_4x4[1], (std::vector<double>{0, -1, 0, 0}));
  EXPECT_EQ(find_pose(poses, "c.jpg"), nullptr);
}

TEST_F(PoseFile, ALineThatIsNoneIsNamed) {
  EXPECT_THAT(wrong_with("a 0 0 0 0 0 0 1\nb 0 0 0 0 0 1\n"), HasSubstr("line 2"));
  EXPECT_THAT(wrong_with("a 0 0 0 0 0 0 1 7\n"), HasSubstr("line 1"));
  EXPECT_THAT(wrong_with("a 0 0 0 0 0 0 0.5\n"), HasSubstr("length is not 1"));
  EXPECT_THAT(wrong_with("a 0 0 0 0 0 0 1\na 0 0 0 0 0 0 1\n"), HasSubstr("second pose of a"));
  EXPECT_THROW(read_poses(folder_ / "none", "world"), std::system_error);
}

TEST_F(PoseFile, ACameraIsNumbersOrAFile) {
  EXPECT_EQ(read_camera("500,501.5,320,240"),
            (contract::Camera{
                .model = "pinhole", .fx_px = 500, .fy_px = 501.5, .cx_px = 320, .cy_px = 240, .distortion = {}}));
  const contract::Camera bent = read_camera("500,500,320,240,-0.2,0.05,0.001,0");
  EXPECT_EQ(bent.model, "opencv");
  EXPECT_EQ(bent.distortion, (std::vector<double>{-0.2, 0.05, 0.001, 0}));
  const fs::path json =
      file(R"({"model":"fisheye","fx_px":190,"fy_px":190,"cx_px":254,"cy_px":256,"distortion":[0,0,0,0]})");
  EXPECT_EQ(read_camera(json.string()).model, "fisheye");
  EXPECT_THROW(read_camera("500,500,320"), std::invalid_argument);
  EXPECT_THROW(read_camera("0,500,320,240"), contract::ContractError);
  EXPECT_THROW(read_camera((folder_ / "none").string()), std::system_error);
}

}  // namespace
}  // namespace mapweld::client
