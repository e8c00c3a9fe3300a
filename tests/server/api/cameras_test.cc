// Cameras and poses on their way through the server, and what localizing and pairs make of them: against the truth of
// the rendered world.
#include <array>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <httplib.h>

#include "client/contract/camera.h"
#include "tests/server/support/api_under_test.h"
#include "tests/support/sample_maps.h"
#include "tests/support/trajectory.h"
#include "tests/support/true_pose.h"

namespace mapweld::test {
namespace {

using contract::Json;
using rendered::Pose;
using ::testing::HasSubstr;

const char* const kCamera =
    R"({"model":"pinhole","fx_px":228,"fy_px":228,"cx_px":159.5,"cy_px":119.5,"distortion":[]})";

std::string escaped(const std::string& text) { return httplib::detail::encode_query_param(text); }

std::string pose_json(const Pose& pose) {
  const std::array<double, 16> m = rendered::matrix_of(pose);
  contract::Pose out{.frame = "building", .matrix_4x4 = {}};
  for (std::size_t r = 0; r < 4; ++r) out.matrix_4x4.push_back({m[4 * r], m[4 * r + 1], m[4 * r + 2], m[4 * r + 3]});
  return contract::dump(Json(out));
}

struct Drive {
  rendered::RenderedWorld world{rendered::WorldOptions{.seed = 402}};
  // The first of a drive's images, near enough to each other to share views.
  std::vector<Pose> poses = first(rendered::trajectory(world, {.n_images = 120}), 8);
  static std::vector<Pose> first(std::vector<Pose> all, std::size_t count) {
    all.resize(count);
    return all;
  }
  std::string seen_from(const Pose& pose) const {
    const auto bytes = rendered::to_jpeg(world.render(pose).bgr);
    return {bytes.begin(), bytes.end()};
  }
};

const Drive& drive() {
  static const Drive one;
  return one;
}

// `relative` is from `a` to `b`; whether it tells the direction.
bool expect_true(const Json& relative, const Pose& a, const Pose& b) {
  const rendered::TruePose truth = rendered::true_pose(a, b);
  const auto found = relative.get<contract::RelativePose>();
  Matrix3 rotation{};
  for (std::size_t i = 0; i < 9; ++i) rotation[i] = found.rotation_3x3.at(i / 3).at(i % 3);
  EXPECT_LT(rendered::angle_deg(rotation, truth.rotation), 3);
  if (!found.direction) return false;
  const std::array<double, 3> direction = {found.direction->at(0), found.direction->at(1), found.direction->at(2)};
  EXPECT_LT(rendered::angle_deg(direction, *truth.direction), 15);
  return true;
}

class Cameras : public ::testing::Test {
 protected:
  Cameras() {
    api_.services().create_map("lab");
    for (std::size_t i = 0; i < drive().poses.size(); ++i) {
      const Answer answer = api_.post_image(
          "/v1/maps/lab/images?name=" + std::to_string(i) + "&pose=" + escaped(pose_json(drive().poses[i])),
          drive().seen_from(drive().poses[i]));
      EXPECT_EQ(answer.status, 201) << answer.body;
    }
  }
  Answer change_map(const std::string& map, const std::string& body) {
    return api_.ask("PATCH", "/v1/maps/" + map, {{"Content-Type", "application/json"}}, body);
  }
  ApiUnderTest api_;
};

TEST_F(Cameras, AMatchSaysHowTheCamerasStand) {
  Pose query = drive().poses[4];
  query.heading_deg += 4;
  query.x_m += 0.2;
  query.y_m += 0.1;
  const std::string image = drive().seen_from(query);
  const Json unknown = api_.post_image("/v1/maps/lab/localize", image).json();
  ASSERT_EQ(unknown["status"], "localized");
  EXPECT_FALSE(unknown["matches"][0].contains("relative"));
  EXPECT_EQ(api_.post_image("/v1/maps/lab/localize?camera=map", image).code(), "invalid_parameter");
  EXPECT_FALSE(api_.post_image("/v1/maps/lab/localize?camera=" + escaped(kCamera), image)
                   .json()["matches"][0]
                   .contains("relative"))
      << "nobody said what took the map's images";

  const Answer changed = change_map("lab", std::string(R"({"camera":)") + kCamera + "}");
  EXPECT_EQ(changed.status, 200) << changed.body;
  EXPECT_EQ(changed.json()["camera"], Json::parse(kCamera));
  int told = 0;
  for (const std::string& camera : {std::string("map"), escaped(kCamera)}) {
    const Json found = api_.post_image("/v1/maps/lab/localize?camera=" + camera, image).json();
    for (const Json& match : found["matches"]) {
      const Pose& there = drive().poses[match["vertex"].get<std::size_t>()];
      EXPECT_EQ(match["pose"], Json::parse(pose_json(there)));
      if (match.contains("relative")) told += expect_true(match["relative"], query, there) ? 1 : 0;
    }
  }
  EXPECT_GT(told, 0);

  EXPECT_EQ(change_map("lab", R"({"camera":{}})").status, 200);
  EXPECT_FALSE(api_.get("/v1/maps/lab").json().contains("camera"));
}

TEST_F(Cameras, APairSaysItFromTheFirstToTheSecond) {
  change_map("lab", std::string(R"({"camera":)") + kCamera + "}");
  int told = 0;
  const Json edges = api_.get("/v1/maps/lab/edges").json();
  for (const Json& edge : edges["items"]) {
    const auto u = edge["u"].get<std::size_t>(), v = edge["v"].get<std::size_t>();
    const Json pair = api_.get("/v1/maps/lab/pairs/" + std::to_string(v) + "/" + std::to_string(u)).json();
    if (pair.contains("relative")) {
      told += expect_true(pair["relative"], drive().poses[u], drive().poses[v]) ? 1 : 0;
    }
  }
  EXPECT_GT(told, 1);
}

TEST_F(Cameras, CamerasAndPosesAreGivenBackAndTravel) {
  const std::string lens =
      R"({"model":"opencv","fx_px":300.0,"fy_px":301.0,"cx_px":160.0,"cy_px":120.0,"distortion":[-0.1,0.01,0.0,0.0]})";
  const std::string metadata = R"([{"camera":)" + lens + "},null]";
  httplib::Client client("127.0.0.1", api_.port());
  const auto part = [&](const Pose& pose, const char* name) {
    return httplib::MultipartFormData{"i", drive().seen_from(pose), name, "image/jpeg"};
  };
  Pose aside = drive().poses[0], further = drive().poses[7];
  aside.heading_deg += 90;
  further.heading_deg += 90;
  const auto batch =
      client.Post("/v1/maps/lab/images/batch?camera=" + escaped(kCamera),
                  httplib::MultipartFormDataItems{
                      {"metadata", metadata, "", "application/json"}, part(aside, "own"), part(further, "common")});
  ASSERT_EQ(batch->status, 200) << batch->body;
  change_map("lab", std::string(R"({"camera":)") + kCamera + "}");
  const Answer file = api_.get("/v1/maps/lab/export");
  ASSERT_EQ(api_.post("/v1/maps:import?name=copy", file.body, "application/vnd.sqlite3").status, 201);
  for (const char* map : {"lab", "copy"}) {
    const std::string path = std::string("/v1/maps/") + map;
    EXPECT_EQ(api_.get(path).json()["camera"], Json::parse(kCamera));
    EXPECT_EQ(api_.get(path + "/vertices?name=own").json()["items"][0]["camera"], Json::parse(lens));
    EXPECT_EQ(api_.get(path + "/vertices?name=common").json()["items"][0]["camera"], Json::parse(kCamera));
    EXPECT_EQ(api_.get(path + "/vertices/3").json()["pose"], Json::parse(pose_json(drive().poses[3])));
    EXPECT_THAT(api_.get(path + "/graph?format=graphml").body, HasSubstr("<data key=\"pose\">{&quot;frame&quot;"));
  }
}

TEST_F(Cameras, WhatIsNoneIsRefusedAndNothingStored) {
  const std::string image = drive().seen_from(drive().poses[0]);
  const auto refused = [&](const std::string& query) {
    const Answer answer = api_.post_image("/v1/maps/lab/images?name=new&" + query, image);
    return answer.code() + ": " + answer.body;
  };
  EXPECT_THAT(refused("camera=" + escaped(R"({"model":"pinhole","fx_px":0,"fy_px":1,"cx_px":0,"cy_px":0})")),
              HasSubstr("invalid_parameter: "));
  EXPECT_THAT(refused("camera=map"), HasSubstr("invalid_parameter: "));
  EXPECT_THAT(refused("camera=" + escaped(R"({"model":"pinhole","focal":3})")), HasSubstr("unknown_field: "));
  EXPECT_THAT(refused("pose=" + escaped(R"({"frame":"lab","matrix_4x4":[[1,0,0,0]]})")), HasSubstr("four rows"));
  EXPECT_EQ(change_map("lab", R"({"camera":{"model":"pinhole"}})").code(), "invalid_parameter");
  EXPECT_EQ(api_.get("/v1/maps/lab/vertices?name=new").json()["items"].size(), 0U);
}

}  // namespace
}  // namespace mapweld::test
