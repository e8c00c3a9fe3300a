// The program render-sample-world, run as its users run it.
#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>
#include <unistd.h>

namespace {

namespace fs = std::filesystem;

class RenderSampleWorld : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() / ("mapweld-render-" + std::to_string(getpid()));
    fs::remove_all(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  int run(const std::string& arguments) const {
    return std::system((std::string(RENDER_SAMPLE_WORLD) + " " + arguments + " > /dev/null 2>&1").c_str());
  }
  static std::vector<std::string> lines(const fs::path& path) {
    std::vector<std::string> result;
    std::ifstream file(path);
    for (std::string line; std::getline(file, line);) result.push_back(line);
    return result;
  }
  static std::string bytes(const fs::path& path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
  }

  fs::path folder_;
};

TEST_F(RenderSampleWorld, WritesImagesAndTruth) {
  ASSERT_EQ(run("--out " + folder_.string() + " --images-a 9 --images-b 7 --queries 3 --seed 2"), 0);
  EXPECT_EQ(std::distance(fs::directory_iterator(folder_ / "robot-a"), {}), 9);
  EXPECT_EQ(std::distance(fs::directory_iterator(folder_ / "robot-b"), {}), 7);
  EXPECT_EQ(std::distance(fs::directory_iterator(folder_ / "queries"), {}), 3);
  const cv::Mat image = cv::imread((folder_ / "robot-b" / "000006.jpg").string());
  EXPECT_EQ(image.size(), cv::Size(320, 240));

  const std::vector<std::string> poses = lines(folder_ / "poses.csv");
  ASSERT_EQ(poses.size(), 1U + 9 + 7 + 3);
  EXPECT_EQ(poses[0], "robot,name,x_m,y_m,heading_deg,floor");
  EXPECT_EQ(poses[1].substr(0, 19), "robot-a,000000.jpg,");
  EXPECT_EQ(std::count(poses[1].begin(), poses[1].end(), ','), 5);

  const std::vector<std::string> visible = lines(folder_ / "visible.csv");
  ASSERT_GT(visible.size(), 3U);
  EXPECT_EQ(visible[0], "query,robot,name,shared");
  const std::vector<std::string> pairs = lines(folder_ / "pairs.csv");
  ASSERT_GT(pairs.size(), 3U);
  EXPECT_EQ(pairs[0], "a,b,shared");
  for (std::size_t i = 1; i < pairs.size(); ++i) {
    const double shared = std::stod(pairs[i].substr(pairs[i].rfind(',') + 1));
    EXPECT_GE(shared, 0.05);
    EXPECT_LE(shared, 1);
  }
}

TEST_F(RenderSampleWorld, DoesNotDependOnTheNumberOfThreads) {
  const std::string what = " --images-a 5 --images-b 4 --queries 2 --look-alike --threads ";
  ASSERT_EQ(run("--out " + (folder_ / "one").string() + what + "1"), 0);
  ASSERT_EQ(run("--out " + (folder_ / "three").string() + what + "3"), 0);
  int files = 0;
  for (const auto& entry : fs::recursive_directory_iterator(folder_ / "one")) {
    if (!entry.is_regular_file()) continue;
    ++files;
    EXPECT_EQ(bytes(entry.path()), bytes(folder_ / "three" / fs::relative(entry.path(), folder_ / "one")));
  }
  EXPECT_EQ(files, 5 + 4 + 2 + 3);
}

TEST_F(RenderSampleWorld, RefusesBadArguments) {
  EXPECT_NE(run(""), 0);
  EXPECT_NE(run("--out " + folder_.string() + " --images-a 0"), 0);
  EXPECT_NE(run("--out /dev/null/nowhere --images-a 2 --images-b 2 --queries 0"), 0);
}

}  // namespace
