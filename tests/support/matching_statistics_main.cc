// matching-statistics: how images of a drive match each other; sets rendered images beside photographs
// (docs/rendered-world.md).
#include <algorithm>
#include <array>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <map>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>
#include <opencv2/calib3d.hpp>
#include <opencv2/features2d.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "tests/support/rendering/repeatable.h"

namespace {

namespace fs = std::filesystem;

struct Picture {
  std::vector<cv::KeyPoint> keypoints;
  cv::Mat descriptors;
};

struct Drive {
  std::vector<std::string> names;
  std::vector<Picture> pictures;
};

// Grey, 320 pixels wide, SIFT at OpenCV's defaults.
Drive load(const std::string& folder) {
  Drive drive;
  for (const auto& entry : fs::directory_iterator(folder)) {
    const std::string extension = entry.path().extension().string();
    if (extension == ".jpg" || extension == ".png") drive.names.push_back(entry.path().filename().string());
  }
  std::sort(drive.names.begin(), drive.names.end());
  const cv::Ptr<cv::SIFT> sift = cv::SIFT::create();
  for (const std::string& name : drive.names) {
    cv::Mat grey = cv::imread((fs::path(folder) / name).string(), cv::IMREAD_GRAYSCALE);
    if (grey.empty()) throw std::runtime_error("cannot read " + name);
    if (grey.cols != 320) cv::resize(grey, grey, {320, grey.rows * 320 / grey.cols}, 0, 0, cv::INTER_AREA);
    Picture picture;
    sift->detectAndCompute(grey, {}, picture.keypoints, picture.descriptors);
    drive.pictures.push_back(std::move(picture));
  }
  return drive;
}

struct Match {
  int matches = 0;
  int inliers = 0;
};

// Nearest neighbours under the ratio 0.8, each feature of b once, and those that agree on a fundamental matrix.
Match match(const Picture& a, const Picture& b) {
  if (a.descriptors.rows < 2 || b.descriptors.rows < 2) return {};
  std::vector<std::vector<cv::DMatch>> nearest;
  cv::BFMatcher(cv::NORM_L2).knnMatch(a.descriptors, b.descriptors, nearest, 2);
  std::map<int, cv::DMatch> best;
  for (const auto& two : nearest) {
    if (two.size() < 2 || two[0].distance >= 0.8F * two[1].distance) continue;
    const auto [place, is_new] = best.try_emplace(two[0].trainIdx, two[0]);
    if (!is_new && two[0].distance < place->second.distance) place->second = two[0];
  }
  std::vector<cv::Point2f> from;
  std::vector<cv::Point2f> to;
  for (const auto& [index, pair] : best) {
    from.push_back(a.keypoints[static_cast<std::size_t>(pair.queryIdx)].pt);
    to.push_back(b.keypoints[static_cast<std::size_t>(index)].pt);
  }
  Match result{static_cast<int>(from.size()), 0};
  if (from.size() < 8) return result;
  cv::Mat mask;
  cv::findFundamentalMat(from, to, cv::USAC_DEFAULT, 1.5, 0.99, 2000, mask);
  result.inliers = mask.empty() ? 0 : cv::countNonZero(mask);
  return result;
}

int quantile(std::vector<int> values, double q) {
  if (values.empty()) return 0;
  std::sort(values.begin(), values.end());
  return values[static_cast<std::size_t>(q * static_cast<double>(values.size() - 1) + 0.5)];
}

class Row {
 public:
  void add(const Match& match) {
    matches_.push_back(match.matches);
    inliers_.push_back(match.inliers);
  }
  void print(const char* name) const {
    const auto many = std::count_if(inliers_.begin(), inliers_.end(), [](int n) { return n >= 25; });
    std::printf("| %-24s | %5zu | %4d | %3d - %3d - %3d | %3.0f %% |\n", name, inliers_.size(), quantile(matches_, 0.5),
                quantile(inliers_, 0.1), quantile(inliers_, 0.5), quantile(inliers_, 0.9),
                inliers_.empty() ? 0.0 : 100.0 * static_cast<double>(many) / static_cast<double>(inliers_.size()));
  }

 private:
  std::vector<int> matches_;
  std::vector<int> inliers_;
};

constexpr int kMaxPairs = 400;
constexpr const char* kHeader =
    "| pairs                    | pairs | matches | inliers 10-50-90 % | >= 25 inliers |\n|---|---|---|---|---|\n";

void features_and_neighbours(const std::string& folder, const Drive& drive) {
  std::vector<int> counts;
  for (const Picture& picture : drive.pictures) counts.push_back(static_cast<int>(picture.keypoints.size()));
  std::printf("\n%s: %zu images, features 5-25-50-75-95 %%: %d - %d - %d - %d - %d\n\n%s", folder.c_str(),
              counts.size(), quantile(counts, 0.05), quantile(counts, 0.25), quantile(counts, 0.5),
              quantile(counts, 0.75), quantile(counts, 0.95), kHeader);
  const int n = static_cast<int>(drive.pictures.size());
  const auto pair = [&](int i, int j) {
    return match(drive.pictures[static_cast<std::size_t>(i)], drive.pictures[static_cast<std::size_t>(j)]);
  };
  for (const int gap : {1, 2, 3, 5, 8, 12}) {
    Row row;
    const int stride = std::max(1, (n - gap) / kMaxPairs);
    for (int i = 0; i + gap < n; i += stride) row.add(pair(i, i + gap));
    row.print(("neighbours, gap " + std::to_string(gap)).c_str());
  }
  mapweld::rendered::Random random(1);
  Row far;
  for (int k = 0; k < kMaxPairs; ++k) {
    const int i = random.below(n);
    const int j = random.below(n);
    if (std::abs(i - j) > std::min(25, n / 3)) far.add(pair(i, j));
  }
  far.print("far apart");
}

// Lines "name in a, name in b[, shared]" after a heading.
void listed_pairs(const std::string& file, const Drive& a, const Drive& b) {
  std::map<std::string, int> in_a;
  std::map<std::string, int> in_b;
  for (std::size_t i = 0; i < a.names.size(); ++i) in_a[a.names[i]] = static_cast<int>(i);
  for (std::size_t i = 0; i < b.names.size(); ++i) in_b[b.names[i]] = static_cast<int>(i);
  struct Line {
    int i, j;
    double shared;
  };
  std::vector<Line> lines;
  std::map<std::pair<int, int>, bool> listed;
  std::ifstream stream(file);
  std::string line;
  std::getline(stream, line);
  while (std::getline(stream, line)) {
    while (!line.empty() && (line.back() == '\r' || line.back() == ' ')) line.pop_back();
    const std::size_t first = line.find(',');
    if (first == std::string::npos) continue;
    const std::size_t second = line.find(',', first + 1);
    const auto i = in_a.find(line.substr(0, first));
    const auto j = in_b.find(line.substr(first + 1, second == std::string::npos ? second : second - first - 1));
    if (i == in_a.end() || j == in_b.end()) continue;
    lines.push_back({i->second, j->second, second == std::string::npos ? 1.0 : std::stod(line.substr(second + 1))});
    listed[{i->second, j->second}] = true;
  }
  std::printf("\npairs of %s\n\n%s", file.c_str(), kHeader);
  mapweld::rendered::Random random(2);
  random.shuffle(lines);
  const auto pair = [&](int i, int j) {
    return match(a.pictures[static_cast<std::size_t>(i)], b.pictures[static_cast<std::size_t>(j)]);
  };
  constexpr std::array<double, 7> kBounds{0.05, 0.1, 0.2, 0.35, 0.5, 0.7, 1.01};
  for (std::size_t bin = 0; bin + 1 < kBounds.size(); ++bin) {
    Row row;
    int count = 0;
    for (const Line& l : lines) {
      if (l.shared < kBounds[bin] || l.shared >= kBounds[bin + 1] || ++count > kMaxPairs) continue;
      row.add(pair(l.i, l.j));
    }
    if (count == 0) continue;
    char name[64];
    std::snprintf(name, sizeof name, "shared %.2f - %.2f", kBounds[bin], std::min(1.0, kBounds[bin + 1]));
    row.print(name);
  }
  Row other;
  for (int k = 0; k < kMaxPairs; ++k) {
    const int i = random.below(static_cast<int>(a.pictures.size()));
    const int j = random.below(static_cast<int>(b.pictures.size()));
    if (!listed.contains({i, j})) other.add(pair(i, j));
  }
  other.print("not listed");
}

int run(int argc, char** argv) {
  CLI::App app{"How the images of drives match: features, neighbours, far pairs, listed pairs.", "matching-statistics"};
  std::vector<std::string> folders;
  std::string pairs;
  app.add_option("folders", folders, "one or two folders of images, in the order of their names")
      ->required()
      ->expected(1, 2);
  app.add_option("--pairs", pairs, "file of pairs (image of the first folder, image of the second[, share])");
  CLI11_PARSE(app, argc, argv);
  cv::setNumThreads(1);
  std::vector<Drive> drives;
  for (const std::string& folder : folders) {
    drives.push_back(load(folder));
    features_and_neighbours(folder, drives.back());
  }
  if (!pairs.empty() && drives.size() == 2) listed_pairs(pairs, drives[0], drives[1]);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return run(argc, argv);
  } catch (const std::exception& error) {
    std::cerr << "matching-statistics: " << error.what() << "\n";
    return 1;
  }
}
