#include "client/contract/camera.h"

#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "client/contract/json.h"
#include "client/contract/map.h"

namespace mapweld::contract {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;

// What is wrong with a request; empty when nothing is.
template <class Document>
std::string wrong_with(const std::string& text) {
  try {
    check(read_request<Document>(parse_json(text)));
  } catch (const ContractError& error) {
    return std::string(error.code().word()) + ": " + error.detail();
  }
  return "";
}

std::string camera(const std::string& model, const std::string& distortion, const std::string& rest) {
  return R"({"model":")" + model + R"(","distortion":)" + distortion + "," + rest + "}";
}
const char* const kPlain = R"("fx_px":500,"fy_px":501.5,"cx_px":320,"cy_px":-3)";

TEST(CameraDocument, TakesEachModelWithItsCoefficients) {
  EXPECT_THAT(wrong_with<Camera>(camera("pinhole", "[]", kPlain)), IsEmpty());
  EXPECT_THAT(wrong_with<Camera>(std::string(R"({"model":"pinhole",)") + kPlain + "}"), IsEmpty());
  EXPECT_THAT(wrong_with<Camera>(camera("opencv", "[0.1,0,0,0]", kPlain)), IsEmpty());
  EXPECT_THAT(wrong_with<Camera>(camera("opencv", "[0.1,0,0,0,2]", kPlain)), IsEmpty());
  EXPECT_THAT(wrong_with<Camera>(camera("fisheye", "[0.1,0,0,0]", kPlain)), IsEmpty());
}

TEST(CameraDocument, SaysWhatCannotBe) {
  EXPECT_THAT(wrong_with<Camera>(camera("lens", "[]", kPlain)), HasSubstr("\"camera.model\" must be one of"));
  EXPECT_THAT(wrong_with<Camera>(camera("pinhole", "[0.1]", kPlain)), HasSubstr("camera.distortion"));
  EXPECT_THAT(wrong_with<Camera>(camera("fisheye", "[0,0,0,0,0]", kPlain)), HasSubstr("camera.distortion"));
  EXPECT_THAT(wrong_with<Camera>(camera("opencv", "[1e3,0,0,0]", kPlain)), HasSubstr("camera.distortion"));
  EXPECT_THAT(wrong_with<Camera>(camera("pinhole", "[]", R"("fx_px":0,"fy_px":5,"cx_px":3,"cy_px":3)")),
              HasSubstr("\"camera.fx_px\" must be greater than 0"));
  EXPECT_THAT(wrong_with<Camera>(camera("pinhole", "[]", R"("fx_px":5,"fy_px":5,"cx_px":3,"cy_px":1e6)")),
              HasSubstr("camera.cy_px"));
  EXPECT_THAT(wrong_with<Camera>(camera("pinhole", "[]", R"("fx_px":5,"fy_px":5,"cx_px":3,"cy_px":3,"skew":0)")),
              HasSubstr("unknown_field"));
}

std::string pose(const std::string& rows, const std::string& last = "[0,0,0,1]") {
  return R"({"frame":"lab","matrix_4x4":[)" + rows + "," + last + "]}";
}

TEST(PoseDocument, HasARotationAndAPlace) {
  EXPECT_THAT(wrong_with<Pose>(pose("[0,-1,0,5],[1,0,0,-2.5],[0,0,1,1e4]")), IsEmpty());
  EXPECT_THAT(wrong_with<Pose>(pose("[1,0.0004,0,0],[0,1,0,0],[0,0,1,0]")), IsEmpty());
  EXPECT_THAT(wrong_with<Pose>(pose("[1,0.01,0,0],[0,1,0,0],[0,0,1,0]")), HasSubstr("within 0.001"));
  EXPECT_THAT(wrong_with<Pose>(pose("[2,0,0,0],[0,1,0,0],[0,0,1,0]")), HasSubstr("within 0.001"));
  EXPECT_THAT(wrong_with<Pose>(pose("[1,0,0,0],[0,1,0,0],[0,0,-1,0]")), HasSubstr("reflection"));
  EXPECT_THAT(wrong_with<Pose>(pose("[1,0,0,0],[0,1,0,0],[0,0,1,0]", "[0,0,0,2]")), HasSubstr("0, 0, 0, 1"));
  EXPECT_THAT(wrong_with<Pose>(pose("[1,0,0,0],[0,1,0,0]")), HasSubstr("four rows"));
  EXPECT_THAT(wrong_with<Pose>(pose("[1,0,0],[0,1,0],[0,0,1]", "[0,0,0]")), HasSubstr("four rows"));
  EXPECT_THAT(wrong_with<Pose>(R"({"frame":"","matrix_4x4":[]})"), HasSubstr("pose.frame"));
  EXPECT_THAT(wrong_with<Pose>(R"({"frame":"lab"})"), HasSubstr("matrix_4x4"));
}

TEST(ChangeMapDocument, TakesACameraAwayByAnEmptyOne) {
  EXPECT_THAT(wrong_with<ChangeMap>(R"({"camera":{}})"), IsEmpty());
  EXPECT_THAT(wrong_with<ChangeMap>(R"({"camera":{"model":"pinhole"}})"), HasSubstr("camera.fx_px"));
}

}  // namespace
}  // namespace mapweld::contract
