#include "client/pose_file.h"

#include <array>
#include <charconv>
#include <cmath>
#include <sstream>
#include <stdexcept>
#include <vector>

#include "client/contract/json.h"
#include "client/image_folder.h"

namespace mapweld::client {
namespace {

constexpr double kUnitWithin = 0.01;  // a quaternion written with two digits still passes; it is made one

// Numbers between commas; none when there is anything else.
std::vector<double> numbers_of(const std::string& text) {
  std::vector<double> numbers;
  std::istringstream in(text);
  for (std::string piece; std::getline(in, piece, ',');) {
    double value = 0;
    const auto [end, error] = std::from_chars(piece.data(), piece.data() + piece.size(), value);
    if (error != std::errc() || end != piece.data() + piece.size()) return {};
    numbers.push_back(value);
  }
  return numbers;
}

// Of a unit quaternion and a place.
std::vector<std::vector<double>> matrix_of(const std::array<double, 3>& t, const std::array<double, 4>& q) {
  const auto [x, y, z, w] = q;
  return {{1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w), t[0]},
          {2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w), t[1]},
          {2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y), t[2]},
          {0, 0, 0, 1}};
}

}  // namespace

contract::Camera read_camera(const std::string& text) {
  contract::Camera camera;
  if (const std::vector<double> n = numbers_of(text); !n.empty()) {
    if (n.size() != 4 && n.size() != 8 && n.size() != 9) {
      throw std::invalid_argument("A camera is fx,fy,cx,cy, perhaps with k1,k2,p1,p2 and k3, or a file.");
    }
    camera = {.model = n.size() == 4 ? "pinhole" : "opencv",
              .fx_px = n[0],
              .fy_px = n[1],
              .cx_px = n[2],
              .cy_px = n[3],
              .distortion = {n.begin() + 4, n.end()}};
  } else {
    camera = contract::read_request<contract::Camera>(contract::parse_json(read_file(text)));
  }
  contract::check(camera);
  return camera;
}

std::map<std::string, contract::Pose> read_poses(const std::filesystem::path& file, const std::string& frame) {
  std::map<std::string, contract::Pose> poses;
  std::istringstream in(read_file(file));
  int number = 0;
  for (std::string line; std::getline(in, line);) {
    ++number;
    const auto refuse = [&](const std::string& why) {
      throw std::invalid_argument(file.string() + ", line " + std::to_string(number) + ": " + why);
    };
    std::istringstream words(line);
    std::string name, rest;
    if (!(words >> name) || name.front() == '#') continue;
    std::array<double, 3> place{};
    std::array<double, 4> turn{};
    for (double& value : place) words >> value;
    for (double& value : turn) words >> value;
    if (!words || words >> rest) refuse("not \"name tx ty tz qx qy qz qw\"");
    double length = 0;
    for (const double value : turn) length += value * value;
    length = std::sqrt(length);
    if (!(std::fabs(length - 1) <= kUnitWithin)) refuse("the quaternion's length is not 1");
    for (double& value : turn) value /= length;
    const contract::Pose pose{.frame = frame, .matrix_4x4 = matrix_of(place, turn)};
    contract::check(pose);
    if (!poses.emplace(name, pose).second) refuse("a second pose of " + name);
  }
  return poses;
}

const contract::Pose* find_pose(const std::map<std::string, contract::Pose>& poses, const std::string& name) {
  for (const std::string& key : {name, name.substr(0, name.rfind('.'))}) {
    if (const auto found = poses.find(key); found != poses.end()) return &found->second;
  }
  return nullptr;
}

}  // namespace mapweld::client
