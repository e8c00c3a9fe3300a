// `mapweld explain`: what it says of a pair, and what it draws.
#include <filesystem>
#include <set>
#include <tuple>

#include <opencv2/imgcodecs.hpp>

#include "tests/client/command/command_fixture.h"
#include "tests/client/drawing/well_formed.h"
#include "tests/core/feature/image_files.h"

namespace mapweld {
namespace {

using contract::Json;
using mapweld::testing::Ended;

struct Explain : mapweld::testing::CommandFixture {
  Explain() {
    script_merge("completed");
    for (const auto& [vertex, map, member_vertex] : {std::tuple(12, "lab-a", 12), std::tuple(71, "lab-b", 11)}) {
      const std::string path = "GET /v1/maps/lab/vertices/" + std::to_string(vertex);
      server.script(path, 200,
                    Json{{"vertex", vertex},
                         {"name", "00" + std::to_string(vertex) + ".jpg"},
                         {"width_px", 64},
                         {"height_px", 48},
                         {"map", map},
                         {"member_vertex", member_vertex}});
      const test::Bytes image = test::encode(".jpg", test::textured_image(64, 48, 1));
      server.script(path + "/image", 200, std::string(image.begin(), image.end()));
    }
  }
  void script_merge(const std::string& state) {
    server.script(
        "GET /v1/merges/3", 200,
        Json{{"id", 3},
             {"state", state},
             {"map", "lab"},
             {"parameters", {{"min_votes", 10}, {"min_inliers", 9}, {"votes", "min"}, {"min_confidence", 0.9}}}});
  }
  void script_pair(const std::string& document) { server.script("GET /v1/merges/3/pairs/12/71", 200, document); }
  void expect_says(const std::vector<std::string>& pieces) {
    const Ended ended = ask("explain 3 12 71");
    EXPECT_EQ(ended.code, 0) << ended.err;
    for (const std::string& piece : pieces) EXPECT_NE(ended.out.find(piece), std::string::npos) << piece << ended.out;
  }
};

const char* const kAccepted = R"({"u":12,"v":71,"votes":29,"matches":41,"inliers":24,"verdict":"accepted",
  "reason":null,"kind":"fundamental","log10_false_alarms":-46.7,"colour":"red",
  "inlier_matches":[{"u":{"x_px":20,"y_px":30},"v":{"x_px":40,"y_px":10}}]})";

TEST_F(Explain, SaysWhatBecameOfAPairInPlainWords) {
  script_pair(kAccepted);
  expect_says({"12 and 71 of lab, merge 3", "0012.jpg, vertex 12 of lab-a", "0071.jpg, vertex 11 of lab-b",
               "29 (10 make a candidate)", "41 one-to-one\n", "24 (9 make an edge)",
               "a fundamental matrix; by chance 1 in 10^47", "an edge of the map: verified, and nobody has judged it"});
  EXPECT_EQ(ask("explain 3 12 71").out.find("reason"), std::string::npos);
  EXPECT_EQ(server.requests()[0], "GET /v1/merges/3/pairs/12/71?matches=true");

  script_pair(R"({"u":12,"v":71,"votes":14,"matches":22,"inliers":7,"verdict":"rejected","reason":"too_few_inliers",
    "kind":"none","log10_false_alarms":300,"inlier_matches":[]})");
  expect_says({"rejected: a candidate that was verified and refused", "too few matches agree on one geometry",
               "none was found"});

  script_pair(R"({"u":12,"v":71,"votes":3,"matches":5,"inliers":0,"verdict":"not_candidate","reason":"no_candidate",
    "kind":"none","log10_false_alarms":300,"inlier_matches":[]})");
  expect_says({"not a candidate", "too few visual words in common", "5 one-to-one; asked for this answer alone"});

  script_pair(R"({"u":12,"v":71,"votes":30,"matches":25,"inliers":20,"verdict":"pending","reason":null,
    "kind":"homography","log10_false_alarms":-20,"inlier_matches":[]})");
  expect_says({"not verified before the merge stopped", "a homography"});
  script_merge("running");
  expect_says({"a candidate that is not verified yet"});
}

TEST_F(Explain, SaysOfAnEdgeThatIsOnlyVerifiedThatItIsNoneAndWhy) {
  Json pair = Json::parse(kAccepted);
  pair["confirmed"] = false;
  pair["confidence"] = 0.125;
  pair["reason"] = "unsupported";
  pair["evidence"] = {{{"name", "rare_matches"}, {"value", 3}, {"weight", -1.5}, {"says", "matches that are rare"}},
                      {{"name", "best_fullness"}, {"value", 4.25}, {"weight", 0.5}, {"says", ""}},
                      {{"name", "shared_view"}, {"value", 0.25}, {"weight", nullptr}, {"says", "of an \u001b image"}}};
  script_pair(pair.dump());
  expect_says({"verified, not confirmed: no edge of the map", "why not", "nothing shows that these two are one place",
               "0.125 (0.9 makes an edge of the map)", "3, speaks against it (-1.5): matches that are rare\n",
               "best fullness", "4.25, speaks for it (+0.5)\n", "0.25: of an "});
  EXPECT_EQ(ask("explain 3 12 71").out.find('\x1b'), std::string::npos);
  EXPECT_EQ(ask("explain 3 12 71 --out " + in_folder("pair.svg")).code, 0);
  const std::string svg = client::read_file(folder.path() / "pair.svg");
  EXPECT_EQ(mapweld::testing::xml_fault(svg), "");

  pair["confirmed"] = true;
  pair["confidence"] = 0.96875;
  pair["reason"] = nullptr;
  script_pair(pair.dump());
  expect_says({"an edge of the map: verified and confirmed", "0.9688 (0.9 makes an edge of the map)"});
  EXPECT_EQ(ask("explain 3 12 71").out.find("not confirmed"), std::string::npos);
}

TEST_F(Explain, SaysOfTwoImagesOfOneMapWhatMappingMadeOfThem) {
  Json pair = Json::parse(kAccepted);
  pair["map"] = "lab-a";
  pair["merge"] = nullptr;
  pair["confirmed"] = false;
  pair["confidence"] = 0.125;
  pair["min_confidence"] = 0.9;
  pair["reason"] = "unsupported";
  pair["evidence"] = {{{"name", "rare_matches"}, {"value", 3}, {"weight", -1.5}, {"says", "matches that are rare"}}};
  server.script("GET /v1/maps/lab-a", 200,
                Json{{"name", "lab-a"}, {"parameters", {{"min_votes", 3}, {"min_inliers", 8}}}});
  script_pair(pair.dump());
  expect_says({"12 and 71 of lab, both of lab-a\n", "29 (3 make a candidate)", "24 (8 make an edge)",
               "verified, not confirmed: no edge of the map", "nothing shows that these two are one place",
               "0.125 (0.9 makes an edge of the map)", "speaks against it (-1.5)"});

  // By the map's name: no merge is asked for.
  server.script("GET /v1/maps/lab/pairs/12/71", 200, pair.dump());
  const Ended by_name = ask("explain lab 12 71");
  EXPECT_EQ(by_name.code, 0) << by_name.err;
  EXPECT_EQ(by_name.out, ask("explain 3 12 71").out);
  server.script("GET /v1/maps/7/pairs/1/2", 200,
                std::string(R"({"u":1,"v":2,"map":"7","merge":null,"votes":40,"matches":30,
    "inliers":20,"verdict":"pending","reason":null})"));
  server.script("GET /v1/maps/7", 200, Json{{"name", "7"}});
  for (int v : {1, 2}) server.script("GET /v1/maps/7/vertices/" + std::to_string(v), 200, Json{{"vertex", v}});
  const Ended a_number = ask("explain --map 7 1 2");
  EXPECT_NE(a_number.out.find("1 and 2 of 7, both within one map"), std::string::npos) << a_number.out << a_number.err;
  EXPECT_NE(a_number.out.find("others had more votes"), std::string::npos) << a_number.out;

  // A merge within the merge: its own rule.
  pair["map"] = "inner";
  pair["merge"] = 2;
  server.script("GET /v1/merges/2", 200, Json{{"id", 2}, {"map", "inner"}, {"parameters", {{"min_votes", 5}}}});
  script_pair(pair.dump());
  expect_says({"12 and 71 of lab, merge 2\n", "29 (5 make a candidate)"});
}

TEST_F(Explain, KnowsEveryReasonAndPassesOnOthers) {
  std::set<std::string> texts;
  for (const char* reason : {"too_few_features", "no_candidate", "too_few_inliers", "not_significant", "inconsistent",
                             "unsupported", "ambiguous", "new_reason"}) {
    Json pair = Json::parse(kAccepted);
    pair["reason"] = reason;
    script_pair(pair.dump());
    const std::string out = ask("explain 3 12 71").out;
    const std::size_t at = out.find("reason");
    ASSERT_NE(at, std::string::npos) << out;
    texts.insert(out.substr(at));
    EXPECT_EQ(out.find(reason) != std::string::npos, std::string(reason) == "new_reason") << out;
  }
  EXPECT_EQ(texts.size(), 8U);
}

TEST_F(Explain, HandsOnTheAnswerAsJson) {
  script_pair(kAccepted);
  EXPECT_EQ(Json::parse(ask("explain 3 12 71 --json").out), Json::parse(kAccepted));
}

TEST_F(Explain, DrawsPngAndSvg) {
  script_pair(kAccepted);
  const Ended ended = ask("explain 3 12 71 --out " + in_folder("pair.png"));
  EXPECT_EQ(ended.code, 0) << ended.err;
  EXPECT_NE(ended.out.find("an edge of the map"), std::string::npos);
  const std::string bytes = client::read_file(folder.path() / "pair.png");
  const cv::Mat png = cv::imdecode(std::vector<std::uint8_t>(bytes.begin(), bytes.end()), cv::IMREAD_COLOR);
  EXPECT_GE(png.cols, 4 * 64);
  EXPECT_GE(png.rows, 2 * 48);

  EXPECT_EQ(ask("explain 3 12 71 --json --out " + in_folder("pair.svg")).code, 0);
  EXPECT_EQ(mapweld::testing::xml_fault(client::read_file(folder.path() / "pair.svg")), "");
}

TEST_F(Explain, LeavesAFileAloneWhenItCannotDraw) {
  script_pair(kAccepted);
  folder.write("kept.png", "old");
  server.script_problem("GET /v1/maps/lab/vertices/71/image", "no_such_image", "The bytes of this image are not kept.");
  const Ended gone = ask("explain 3 12 71 --out " + in_folder("kept.png"));
  EXPECT_EQ(gone.code, 1);
  EXPECT_NE(gone.err.find("no_such_image"), std::string::npos) << gone.err;
  EXPECT_EQ(ask("explain 3 12 71").code, 0);  // the words need no image
  server.script("GET /v1/maps/lab/vertices/71/image", 200, std::string("no picture"));
  EXPECT_EQ(ask("explain 3 12 71 --out " + in_folder("kept.png")).code, 1);
  EXPECT_EQ(client::read_file(folder.path() / "kept.png"), "old");
  EXPECT_EQ(ask("explain 3 12 71 --out /nowhere/pair.png").code, 2);
  std::size_t files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder.path())) files += entry.exists() ? 1 : 0;
  EXPECT_EQ(files, 3U);  // kept.png, out.txt, err.txt
}

TEST_F(Explain, ServerProblemsAreOne) {
  server.script_problem("GET /v1/merges/3/pairs/12/13", "invalid_parameter", "Both are of \"lab-a\".");
  const Ended ended = ask("explain 3 12 13");
  EXPECT_EQ(ended.code, 1);
  EXPECT_EQ(ended.out, "");
  EXPECT_NE(ended.err.find("Both are of \"lab-a\". (invalid_parameter, HTTP 422"), std::string::npos) << ended.err;
}

}  // namespace
}  // namespace mapweld
