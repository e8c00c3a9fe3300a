// `mapweld-server evaluate` from a stored pair of maps to the files that it writes.
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>

#include "server/commands/evaluate.h"
#include "tests/core/geometry/two_view_scene.h"
#include "tests/server/commands/run_command.h"
#include "tests/support/temp_store.h"

namespace mapweld::test {
namespace {

using ::testing::ContainsRegex;
using ::testing::HasSubstr;
using ::testing::Not;
namespace fs = std::filesystem;

constexpr int kPlaces = 8;

Ran evaluate(const std::string& arguments) {
  return run_command(server::add_evaluate_command, "evaluate " + arguments);
}

std::string text_of(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

// Maps "first" and "second": each place seen by both, each map a path from place to place. The last place of "first" is
// seen nowhere else.
class EvaluateCommand : public ::testing::Test {
 protected:
  EvaluateCommand() {
    const VocabularyId vocabulary = add_vocabulary(store_);
    cv::imencode(".png", cv::Mat(240, 320, CV_8UC3, cv::Scalar(90, 120, 60)), png_);
    for (const bool is_second : {false, true}) {
      WriteTransaction db = store_.write();
      const VerifierId verifier = test_verifier(db);
      const MapId map = insert_map(db, new_map(is_second ? "second" : "first", vocabulary));
      for (int place = 0; place < kPlaces + (is_second ? 0 : 1); ++place) {
        SceneOptions options;
        options.seed = static_cast<std::uint64_t>(place) + 1;
        options.first_word = static_cast<std::uint32_t>(place) * 400;
        options.clutter = 20;
        const TwoViewScene scene = make_scene(options);
        const AppearanceVector& image = is_second ? scene.b : scene.a;
        NewImage row = new_image((is_second ? "s" : "f") + std::to_string(place) + ".png", image);
        row.bytes = png_;
        std::vector<NewEdge> edges;
        if (place > 0) {
          NewEdge edge;
          edge.u = VertexId{static_cast<std::uint32_t>(place) - 1};
          edge.verification.accepted = true;
          edge.verification.inliers = 20;
          edges.push_back(edge);
        }
        insert_vertex(db, map, vocabulary, row, image, edges, verifier);
      }
      db.commit();
    }
    // f0 - s0 is missing from the truth: found all the same, it counts as wrong.
    std::ofstream truth(folder_.path() / "pairs.csv");
    truth << "a,b\n";
    for (int place = 1; place < kPlaces; ++place) truth << "f" << place << ".png,s" << place << ".png\n";
  }

  std::string data() { return (store_.folder() / "data").string(); }
  fs::path out() { return folder_.path() / "out"; }
  std::string truth() { return (folder_.path() / "pairs.csv").string(); }

  TempStore store_;
  TempFolder folder_;
  std::vector<std::uint8_t> png_;
};

TEST_F(EvaluateCommand, WritesReportFiguresAndSheetsBesideAServer) {
  const Ran run = evaluate("--data " + data() + " --maps first second --methods quickconnect,brute-force --truth " +
                           truth() + " --sample-edges 3 --out " + out().string());
  ASSERT_EQ(run.exit_code, 0) << run.errors;
  EXPECT_THAT(run.errors, HasSubstr("quickconnect"));
  const std::string report = text_of(out() / "report.md");
  EXPECT_THAT(report, HasSubstr("| vertices | 9 + 8 |"));
  EXPECT_THAT(report, HasSubstr("| verified edges between the maps, when all candidates are | 8 |"));
  EXPECT_THAT(report, HasSubstr("| of them confirmed by the alias guard | "));
  EXPECT_THAT(report, HasSubstr("| components of the finished merge | 1 |"));
  EXPECT_THAT(report, HasSubstr("accepted with the parameters above | 8, right 7: precision 87.50 %"));
  EXPECT_THAT(report, HasSubstr("| of them with a right edge | 7: 100.0 % |"));
  for (const char* name : {"figure-5", "figure-6-time", "figure-6-verifications", "figure-6-modelled-time", "figure-7",
                           "wrong-edges", "precision-recall"}) {
    EXPECT_THAT(text_of(out() / (std::string(name) + ".svg")), HasSubstr("</svg>")) << name;
  }
  for (const char* name : {"figure-5", "figure-6", "figure-7", "wrong-edges", "precision-recall", "localization"}) {
    EXPECT_THAT(text_of(out() / (std::string(name) + ".csv")), HasSubstr(",")) << name;
  }
  EXPECT_THAT(text_of(out() / "edges.csv"), HasSubstr("f3.png,s3.png,"));
  EXPECT_THAT(text_of(out() / "edges.csv"), ContainsRegex("f3.png,s3.png,[0-9]+,[0-9]+,[01],[0-9.]+,[01]\n"));
  EXPECT_THAT(text_of(out() / "wrong-edges-sheet.csv"), HasSubstr("1,f0.png,s0.png,"));
  EXPECT_FALSE(cv::imread((out() / "wrong-edges-sheet-1.png").string()).empty());
  EXPECT_FALSE(cv::imread((out() / "edges-sheet-1.png").string()).empty());
}

TEST_F(EvaluateCommand, SharesVerdictsOnRequestAndSaysSo) {
  const Ran run = evaluate("--data " + data() + " --maps second first --memo --runs 2 --out " + out().string());
  ASSERT_EQ(run.exit_code, 0) << run.errors;
  const std::string report = text_of(out() / "report.md");
  EXPECT_THAT(report, HasSubstr("| vertices | 8 + 9 |"));
  EXPECT_THAT(report, HasSubstr("counted in verifications only"));
  EXPECT_FALSE(fs::exists(out() / "figure-6-time.svg"));
  EXPECT_FALSE(fs::exists(out() / "wrong-edges.svg"));
}

TEST_F(EvaluateCommand, CountsConfirmedEdgesOnRequest) {
  const Ran run = evaluate("--data " + data() + " --maps first second --methods quickconnect --confirmed --truth " +
                           truth() + " --out " + out().string());
  ASSERT_EQ(run.exit_code, 0) << run.errors;
  const std::string report = text_of(out() / "report.md");
  EXPECT_THAT(report, HasSubstr("confirmed by the alias guard: **these count** (`--confirmed`)"));
  EXPECT_THAT(report, HasSubstr(" --confirmed"));
  EXPECT_THAT(report, HasSubstr("| verified edges between the maps, when all candidates are | 8 |"));
  EXPECT_THAT(text_of(out() / "edges.csv"), HasSubstr("f3.png,s3.png,")) << "the withheld ones are told as well";
}

TEST_F(EvaluateCommand, ChangesNothingInTheStore) {
  const auto merges = [&] {
    const ReadTransaction db = store_.read();
    return list_maps(db, 100).size();
  };
  ASSERT_EQ(merges(), 2u);
  ASSERT_EQ(evaluate("--data " + data() + " --maps first second --out " + out().string()).exit_code, 0);
  EXPECT_EQ(merges(), 2u);
}

TEST_F(EvaluateCommand, SaysWhatItCannotDo) {
  const auto refusal = [&](const std::string& rest) {
    const Ran run = evaluate("--data " + data() + " --out " + out().string() + " " + rest);
    EXPECT_EQ(run.exit_code, 1) << rest;
    return run.errors;
  };
  EXPECT_THAT(refusal("--maps first third"), HasSubstr("no map named \"third\""));
  EXPECT_THAT(refusal("--maps first second --methods by-magic"), HasSubstr("by-magic"));
  std::ofstream(folder_.path() / "nonsense.csv") << "x\n1\n";
  EXPECT_THAT(refusal("--maps first second --truth " + (folder_.path() / "nonsense.csv").string()),
              HasSubstr("two columns"));
}

}  // namespace
}  // namespace mapweld::test
