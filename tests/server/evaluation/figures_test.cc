// Shapes of what is written: CSV, Markdown and SVG; and the averages that a figure shows.
#include "server/evaluation/figures.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <sstream>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "server/evaluation/method_series.h"
#include "server/evaluation/report.h"
#include "tests/client/drawing/well_formed.h"
#include "tests/core/merge/toy_maps.h"

namespace mapweld::server::evaluation {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

Evaluation small_evaluation(bool memo = false) {
  EvaluationOptions options;
  options.memo = memo;
  options.runs = 3;
  options.curve_points = 6;
  return evaluate(test::make_toy_merge(test::toy_world(5)), options);
}

ReportHead small_head() {
  ReportHead head;
  head.map_a = "lab";
  head.map_b = "hall";
  head.command = "mapweld-server evaluate ...";
  head.verifier_version = "hash-1";
  return head;
}

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  return lines;
}

// The last line of a method in a CSV.
std::string last_line_of(const std::string& method, const std::string& csv) {
  std::string last;
  for (const std::string& line : lines_of(csv)) {
    if (line.starts_with(method + ",")) last = line;
  }
  return last;
}

void expect_table(const OutputFile& file) {
  const std::vector<std::string> lines = lines_of(file.content);
  ASSERT_GT(lines.size(), 1u) << file.name;
  const auto columns = std::ranges::count(lines.front(), ',');
  for (const std::string& line : lines) EXPECT_EQ(std::ranges::count(line, ','), columns) << file.name << ": " << line;
}

const OutputFile& file_named(const std::vector<OutputFile>& files, const std::string& name) {
  return *std::ranges::find(files, name, &OutputFile::name);
}

TEST(Figures, AreWellFormedAndTheirTablesRectangular) {
  const Evaluation evaluation = small_evaluation();
  const std::vector<OutputFile> files = figures(evaluation, "a <1> & \"b\"");
  std::vector<std::string> names;
  for (const OutputFile& file : files) {
    names.push_back(file.name);
    if (file.name.ends_with(".svg")) {
      EXPECT_EQ(mapweld::testing::xml_fault(file.content), "") << file.name;
      EXPECT_THAT(file.content, Not(HasSubstr("nan"))) << file.name;
    } else {
      expect_table(file);
    }
  }
  EXPECT_THAT(names, ::testing::UnorderedElementsAre("figure-5.svg", "figure-5.csv", "figure-6.csv", "levels.csv",
                                                     "figure-7.svg", "figure-7.csv", "figure-6-time.svg",
                                                     "figure-6-verifications.svg", "figure-6-modelled-time.svg"));
  for (const MethodResult& method : evaluation.methods) {
    EXPECT_THAT(file_named(files, "figure-5.svg").content, HasSubstr(style_of_method(method.method).colour));
  }
}

TEST(Figures, Figure6EndsAtTheFinalValue) {
  const Evaluation evaluation = small_evaluation();
  const std::vector<std::string> lines = lines_of(file_named(figures(evaluation, "ab"), "figure-6.csv").content);
  EXPECT_EQ(lines.front(),
            "method,run,seed,edges,verifications,time_s,modelled_time_s,connectivity,normalised_connectivity,"
            "joined_vertices,independent_joins");
  std::vector<std::string> last;
  std::istringstream fields(last_line_of("brute-force", file_named(figures(evaluation, "ab"), "figure-6.csv").content));
  for (std::string field; std::getline(fields, field, ',');) last.push_back(field);
  EXPECT_EQ(last[3], std::to_string(evaluation.finished.edges));
  EXPECT_EQ(last[4], std::to_string(evaluation.candidates));
  EXPECT_NEAR(std::stod(last[8]), 1, 1e-9);
}

// The cells of a line of CSV.
std::vector<std::string> cells_of(const std::string& line) {
  std::vector<std::string> cells;
  std::istringstream fields(line);
  for (std::string field; std::getline(fields, field, ',');) cells.push_back(field);
  return cells;
}

TEST(Figures, SetEveryMethodBesideTheClairvoyant) {
  const Evaluation evaluation = small_evaluation();
  const std::vector<OutputFile> files = figures(evaluation, "ab");
  const std::string& levels = file_named(files, "levels.csv").content;
  EXPECT_THAT(lines_of(levels).front(), ::testing::EndsWith(",clairvoyant_edges,to_clairvoyant,least_edges"));
  const LevelLimit& limit = evaluation.limit.levels.back();  // 99 %
  ASSERT_TRUE(limit.clairvoyant.has_value());
  const std::vector<std::string> clairvoyant = cells_of(last_line_of("clairvoyant", levels));
  ASSERT_EQ(clairvoyant.size(), 19u);
  EXPECT_EQ(clairvoyant[4], std::to_string(limit.clairvoyant->edges)) << "one verification an edge";
  EXPECT_EQ(clairvoyant[10], std::to_string(limit.clairvoyant->edges));
  EXPECT_EQ(clairvoyant[17], "1");
  const std::vector<std::string> baseline = cells_of(last_line_of("brute-force", levels));
  EXPECT_EQ(baseline[16], clairvoyant[4]);
  EXPECT_NEAR(std::stod(baseline[17]), std::stod(baseline[4]) / std::stod(clairvoyant[4]), 1e-6);
  EXPECT_EQ(baseline[18], std::to_string(limit.least_edges));

  const std::string& curves = file_named(files, "figure-6.csv").content;
  const std::vector<std::string> bound = cells_of(last_line_of("bound", curves));
  EXPECT_EQ(bound[3], std::to_string(evaluation.finished.edges)) << "all of them are in the final component here";
  EXPECT_NEAR(std::stod(bound[8]), 1, 1e-9);
  EXPECT_EQ(cells_of(last_line_of("clairvoyant", curves))[3], clairvoyant[4]);
  EXPECT_THAT(file_named(files, "figure-6-verifications.svg").content, HasSubstr("clairvoyant"));
  EXPECT_THAT(file_named(files, "figure-6-time.svg").content, Not(HasSubstr("clairvoyant")));
  EXPECT_THAT(markdown_report(small_head(), evaluation, nullptr), HasSubstr("| **clairvoyant** |"));
}

TEST(Figures, ShowNoTimeWhenVerdictsWereShared) {
  const Evaluation evaluation = small_evaluation(true);
  for (const OutputFile& file : figures(evaluation, "ab")) {
    EXPECT_NE(file.name, "figure-6-time.svg");
    EXPECT_NE(file.name, "figure-6-modelled-time.svg");
    EXPECT_THAT(file.content, Not(HasSubstr("time (s)"))) << file.name;
  }
  const std::string report = markdown_report(small_head(), evaluation, nullptr);
  EXPECT_THAT(report, HasSubstr("counted in verifications only"));
  EXPECT_THAT(report, Not(HasSubstr("time (s)")));
}

TEST(MethodSeries, IsMeanAndDeviationOfTheRunsAtEachCost) {
  MethodResult method;
  method.method = "random";
  for (const std::uint64_t step : {10u, 20u}) {  // an edge every 10 verifications, and every 20
    RecordedRun run;
    for (std::uint64_t i = 1; i <= 5; ++i) {
      run.edges.push_back(
          {VertexId{0}, VertexId{1}, 1, 1, {.verifications = i * step, .elapsed_s = 0, .verifier_s = 0}});
    }
    run.cost.verifications = 100;
    method.runs.push_back(run);
  }
  const ChartSeries series = method_series(method, CostAxis::kVerifications, 0, 1, {},
                                           [](std::size_t, std::uint64_t edges) { return static_cast<double>(edges); });
  ASSERT_EQ(series.points.size(), series.spread.size());
  for (std::size_t i = 0; i < series.points.size(); ++i) {
    const double x = series.points[i].x;
    const double first = std::min(5.0, std::floor(x / 10)), second = std::floor(x / 20);
    EXPECT_DOUBLE_EQ(series.points[i].y, (first + second) / 2) << x;
    EXPECT_NEAR(series.spread[i], std::abs(first - second) / std::sqrt(2.0), 1e-12) << x;
  }
  EXPECT_EQ(series.points.back().x, 100);
}

TEST(MethodSeries, InterpolatesBetweenComputedPoints) {
  const std::vector<CurvePoint> curve{{0, 0, 0, 0}, {10, 2, 20, 10}, {20, 3, 30, 10}};
  EXPECT_DOUBLE_EQ(interpolated(curve, 5).connectivity, 1);
  EXPECT_EQ(interpolated(curve, 5).joined_vertices, 10u);
  EXPECT_DOUBLE_EQ(interpolated(curve, 10).connectivity, 2);
  EXPECT_DOUBLE_EQ(interpolated(curve, 15).connectivity, 2.5);
  EXPECT_DOUBLE_EQ(interpolated(curve, 99).connectivity, 3);
}

// Tables in a Markdown text: every row has as many cells as its head.
int expect_markdown_tables(const std::string& text) {
  int tables = 0;
  std::ptrdiff_t cells = 0;
  for (const std::string& line : lines_of(text)) {
    if (!line.starts_with("|")) {
      cells = 0;
      continue;
    }
    if (cells == 0) {
      cells = std::ranges::count(line, '|');
      ++tables;
    }
    EXPECT_EQ(std::ranges::count(line, '|'), cells) << line;
    EXPECT_TRUE(line.ends_with("|")) << line;
  }
  return tables;
}

TEST(Report, HasATableForEachLevelAndARowForEachMethod) {
  const Evaluation evaluation = small_evaluation();
  const std::string report = markdown_report(small_head(), evaluation, nullptr);
  EXPECT_EQ(expect_markdown_tables(report), 8) << "head, share, clairvoyant, four levels, whole";
  for (const char* level : {"50 %", "90 %", "95 %", "99 %"}) {
    EXPECT_THAT(report, HasSubstr(std::string("## To ") + level + " of the final value"));
  }
  for (const MethodResult& method : evaluation.methods) {
    const std::string begin = "| `" + method.method + "`";
    int rows = 0;
    for (const std::string& line : lines_of(report)) rows += line.starts_with(begin) ? 1 : 0;
    EXPECT_EQ(rows, 7) << method.method;
  }
  EXPECT_THAT(report, HasSubstr("20 ms for each verification"));
  EXPECT_THAT(report, Not(HasSubstr("nan")));
}

TEST(Report, SaysWhatTheTruthSays) {
  const Evaluation evaluation = small_evaluation();
  std::array<NamedMap, 2> maps{NamedMap{"a", {}}, NamedMap{"b", {}}};
  for (std::size_t m = 0; m < 2; ++m) {
    for (std::uint32_t v = 0; v < evaluation.member_vertices[m]; ++v) maps[m].images.push_back(std::to_string(v));
  }
  std::string csv = "a,b\n";
  std::vector<CandidateVerdict> verdicts;
  for (const RecordedEdge& edge : evaluation.all_edges) {
    const MapPair pair = pair_of(edge, evaluation.member_vertices[0]);
    verdicts.push_back({pair.a, pair.b, edge.votes, static_cast<int>(edge.inliers), -9, true});
    if (verdicts.size() % 2 == 0) csv += std::to_string(pair.a) + "," + std::to_string(pair.b) + "\n";
  }
  ASSERT_GT(verdicts.size(), 3u);
  const TruthResult truth = judge(verdicts, Truth::parse(csv, maps), test::make_toy_merge(test::toy_world(5)),
                                  evaluation, {.min_inliers = 10, .max_false_alarms = 1e-6});
  const std::string report = markdown_report(small_head(), evaluation, &truth);
  EXPECT_EQ(expect_markdown_tables(report), 11);
  EXPECT_THAT(report, HasSubstr("precision is a lower bound"));
  for (const OutputFile& file : truth_figures(evaluation, truth, "ab")) {
    if (file.name.ends_with(".svg")) {
      EXPECT_EQ(mapweld::testing::xml_fault(file.content), "") << file.name;
    } else {
      expect_table(file);
    }
  }
  const std::string count = std::to_string((verdicts.size() + 1) / 2);
  EXPECT_THAT(
      last_line_of("brute-force", file_named(truth_figures(evaluation, truth, "ab"), "wrong-edges.csv").content),
      ::testing::EndsWith("," + count + "," + count));
}

}  // namespace
}  // namespace mapweld::server::evaluation
