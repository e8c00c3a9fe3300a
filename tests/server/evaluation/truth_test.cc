#include "server/evaluation/truth.h"

#include <array>
#include <cmath>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "core/geometry/portable_math.h"
#include "server/evaluation/truth_metrics.h"

namespace mapweld::server::evaluation {
namespace {

const std::array<NamedMap, 2> kMaps{NamedMap{"lap-1", {"001.jpg", "002.jpg", "003.jpg"}},
                                    NamedMap{"lap-2", {"041.jpg", "042.jpg"}}};

TEST(Truth, ReadsPairsAsTheyAreNamed) {
  const Truth truth = Truth::parse("a,b\n001.jpg,042.jpg\r\n003.jpg,041.jpg\n999.jpg,041.jpg\n", kMaps);
  EXPECT_TRUE(truth.is_right(0, 1));
  EXPECT_TRUE(truth.is_right(2, 0));
  EXPECT_FALSE(truth.is_right(1, 0));
  EXPECT_EQ(truth.right_pairs(), 2u);
  EXPECT_EQ(truth.lines(), 3u);
  EXPECT_EQ(truth.unknown_lines(), 1u);
  EXPECT_FALSE(truth.is_graded());
  EXPECT_FALSE(truth.is_complete());
}

TEST(Truth, FindsTheOrderOfOtherColumns) {
  const Truth truth = Truth::parse("later_image,earlier_image\n041.jpg,001.jpg\n041.jpg,002.jpg\n", kMaps);
  EXPECT_TRUE(truth.is_right(0, 0));
  EXPECT_TRUE(truth.is_right(1, 0));
  EXPECT_EQ(truth.right_pairs(), 2u);
}

TEST(Truth, KeepsTheOrderOfAAndBWhereNamesCannotTell) {
  const std::array<NamedMap, 2> maps{NamedMap{"a", {"0", "1"}}, NamedMap{"b", {"0", "1", "2"}}};
  const Truth truth = Truth::parse("a,b,shared\n0,1,0.5\n1,0,0.07\n1,1,0.1\n", maps);
  EXPECT_TRUE(truth.is_right(0, 1));
  EXPECT_FALSE(truth.is_right(1, 0)) << "shares too little";
  EXPECT_TRUE(truth.is_listed(1, 0));
  EXPECT_TRUE(truth.is_right(1, 1));
  EXPECT_FALSE(truth.is_listed(0, 0));
  EXPECT_TRUE(truth.is_graded());
  EXPECT_EQ(truth.placed_in_second(3), (std::vector<bool>{false, true, false}));
}

TEST(Truth, MakesPairsOfPoses) {
  const std::string csv =
      "robot,name,x_m,y_m,heading_deg,floor\n"
      "robot-a,001.jpg,0,0,350,0\n"
      "robot-a,002.jpg,0,0,180,0\n"
      "robot-a,003.jpg,0,0,350,1\n"
      "robot-b,041.jpg,3,0,20,0\n"
      "robot-b,042.jpg,2,3,0,0\n";
  const Truth truth = Truth::parse(csv, kMaps);
  EXPECT_TRUE(truth.is_right(0, 0)) << "3 m apart, 30 degrees across north";
  EXPECT_FALSE(truth.is_right(0, 1)) << "3.6 m apart";
  EXPECT_FALSE(truth.is_right(1, 0)) << "looks the other way";
  EXPECT_FALSE(truth.is_right(2, 0)) << "another floor";
  EXPECT_EQ(truth.right_pairs(), 1u);
  const Truth wide = Truth::parse(csv, kMaps, {.min_shared = 0.1, .max_distance_m = 4, .max_turn_deg = 29});
  EXPECT_TRUE(wide.is_right(0, 1));
  EXPECT_FALSE(wide.is_right(0, 0));
}

TEST(Truth, RefusesWhatItCannotRead) {
  EXPECT_THROW(Truth::parse("", kMaps), TruthError);
  EXPECT_THROW(Truth::parse("a\n001.jpg\n", kMaps), TruthError);
  EXPECT_THROW(Truth::parse("a,b,shared\n001.jpg,041.jpg\n", kMaps), TruthError);
  EXPECT_THROW(Truth::parse("a,b,shared\n001.jpg,041.jpg,much\n", kMaps), TruthError);
  EXPECT_THROW(Truth::parse("name,x_m\n001.jpg,1\n", kMaps), TruthError);
}

TEST(PrecisionRecall, IsCountedByHand) {
  // Scores 9 right, 8 right, 8 wrong, 5 right; four right pairs in all, one of them no candidate.
  const std::vector<PrecisionRecall> points = precision_recall({{5, true}, {8, true}, {9, true}, {8, false}}, 4);
  ASSERT_EQ(points.size(), 3u);
  EXPECT_EQ(points[0].threshold, 9);
  EXPECT_DOUBLE_EQ(points[0].precision, 1);
  EXPECT_DOUBLE_EQ(points[0].recall, 0.25);
  EXPECT_EQ(points[1].accepted, 3u) << "equal scores are accepted together";
  EXPECT_DOUBLE_EQ(points[1].precision, 2.0 / 3);
  EXPECT_DOUBLE_EQ(points[1].recall, 0.5);
  EXPECT_DOUBLE_EQ(points[2].precision, 0.75);
  EXPECT_DOUBLE_EQ(points[2].recall, 0.75);
  const auto full = at_full_precision(points);
  ASSERT_TRUE(full);
  EXPECT_EQ(full->threshold, 9);
  EXPECT_FALSE(at_full_precision(precision_recall({{2, false}, {1, true}}, 1)));
}

CandidateVerdict verdict(std::uint32_t a, std::uint32_t b, std::uint32_t votes, int inliers, double log10_alarms,
                         bool plausible = true) {
  return {a, b, votes, inliers, log10_alarms, plausible};
}

// Map "a" has 4 images, "b" has 3. Right: (0,0) (1,0) (1,1) (3,1). Images 0 and 1 of b have a place in a, 2 has none.
Truth small_truth() {
  const std::array<NamedMap, 2> maps{NamedMap{"a", {"a0", "a1", "a2", "a3"}}, NamedMap{"b", {"b0", "b1", "b2"}}};
  return Truth::parse("a,b\na0,b0\na1,b0\na1,b1\na3,b1\n", maps);
}

const std::vector<CandidateVerdict> kVerdicts{
    verdict(0, 0, 30, 40, -20),         // right
    verdict(1, 0, 50, 12, -3),          // right, hardly significant
    verdict(1, 1, 11, 9, -9),           // right, few inliers
    verdict(2, 0, 60, 11, -8),          // wrong
    verdict(2, 1, 40, 30, -15, false),  // wrong, refused for another reason
    verdict(3, 2, 20, 15, -12),         // wrong
};

TEST(Verdicts, AreAcceptedByBothThresholds) {
  const VerifierOptions thresholds{.min_inliers = 10, .max_false_alarms = 1e-6};
  std::vector<bool> accepted;
  for (const CandidateVerdict& v : kVerdicts) accepted.push_back(accepts(v, thresholds));
  EXPECT_EQ(accepted, (std::vector<bool>{true, false, false, true, false, true}));
}

// The maps of small_truth, each a path, with 60 features an image; b2 has 10. Accepted: a0-b0, a2-b0, a3-b2.
MergeInput small_input() {
  MergeInput input;
  input.members = number_members({4, 3});
  input.inner_edges = {{VertexId{0}, VertexId{1}, 1},
                       {VertexId{1}, VertexId{2}, 1},
                       {VertexId{2}, VertexId{3}, 1},
                       {VertexId{4}, VertexId{5}, 1},
                       {VertexId{5}, VertexId{6}, 1}};
  std::vector<std::shared_ptr<const AppearanceVector>> images;
  for (std::size_t v = 0; v < 7; ++v) {
    AppearanceVector image;
    image.appearances.resize(v == 6 ? 10 : 60);
    images.push_back(std::make_shared<const AppearanceVector>(image));
  }
  input.appearances = std::make_shared<AppearanceTable>(std::move(images));
  return input;
}

Evaluation small_evaluation() {
  Evaluation evaluation;
  evaluation.member_vertices = {4, 3};
  evaluation.all_edges.resize(3);
  evaluation.all_edges[0].u = VertexId{0}, evaluation.all_edges[0].v = VertexId{4};
  evaluation.all_edges[1].u = VertexId{2}, evaluation.all_edges[1].v = VertexId{4};
  evaluation.all_edges[2].u = VertexId{3}, evaluation.all_edges[2].v = VertexId{6};
  evaluation.final_connectivity = 0.5;
  return evaluation;
}

TEST(TruthResult, CountsWhatIsJoinable) {
  const std::array<NamedMap, 2> maps{NamedMap{"a", {"a0", "a1", "a2", "a3"}}, NamedMap{"b", {"b0", "b1", "b2"}}};
  const Truth truth = Truth::parse("a,b,shared\na0,b0,0.4\na1,b1,0.29\na3,b1,0.31\na3,b2,0.9\n", maps);
  const TruthResult result =
      judge(kVerdicts, truth, small_input(), small_evaluation(), {.min_inliers = 10, .max_false_alarms = 1e-6});
  EXPECT_EQ(result.placed, 3u);
  EXPECT_EQ(result.joinable, 2u) << "b2 has too few features";
  EXPECT_EQ(result.joinable_joined, 1u) << "b0";
}

TEST(TruthResult, IsCountedByHand) {
  const TruthResult result =
      judge(kVerdicts, small_truth(), small_input(), small_evaluation(), {.min_inliers = 10, .max_false_alarms = 1e-6});
  // The only right edge, a0 - b0, makes a path of seven vertices.
  EXPECT_NEAR(result.right_connectivity, (2 - 2 * std::cos(std::acos(-1.0) / 7)) / 0.5, 1e-9);
  EXPECT_EQ(result.candidates, 6u);
  EXPECT_EQ(result.right_candidates, 3u);
  EXPECT_EQ(result.chosen.accepted, 3u);
  EXPECT_EQ(result.chosen.right, 1u);
  EXPECT_DOUBLE_EQ(result.chosen.precision, 1.0 / 3);
  EXPECT_DOUBLE_EQ(result.chosen.recall, 0.25);
  EXPECT_EQ(result.unlisted, 2u);
  EXPECT_EQ(result.placed, 2u);
  EXPECT_EQ(result.rightly_joined, 1u);
  ASSERT_EQ(result.by_inliers.size(), 5u) << "40, 15, 12, 11, 9";
  EXPECT_EQ(result.by_inliers[1].threshold, 15);
  EXPECT_DOUBLE_EQ(result.by_inliers[1].precision, 0.5);
  EXPECT_DOUBLE_EQ(result.by_inliers.back().recall, 0.75);
  // Nothing wrong has more than 15 inliers or fewer than 10^-12 false alarms; the mildest that keeps them out.
  ASSERT_TRUE(result.without_error);
  EXPECT_EQ(result.without_error->result.right, 1u);
  EXPECT_EQ(result.without_error->result.accepted, 1u);
}

TEST(SuggestedThresholds, AreTheBestOfAllPairsOfThem) {
  for (const double precision : {0.0, 0.5, 0.6, 0.75, 1.0}) {
    const Truth truth = small_truth();
    std::uint64_t best = 0;
    bool found = false;
    for (int inliers = 8; inliers <= 64; ++inliers) {
      for (int log10_alarms = 0; log10_alarms >= -40; --log10_alarms) {
        std::uint64_t accepted = 0, right = 0;
        for (const CandidateVerdict& v : kVerdicts) {
          if (!v.plausible || v.inliers < inliers || v.log10_false_alarms > log10_alarms) continue;
          ++accepted;
          right += truth.is_right(v.a, v.b) ? 1 : 0;
        }
        if (accepted == 0 || static_cast<double>(right) < precision * static_cast<double>(accepted)) continue;
        found = true;
        best = std::max(best, right);
      }
    }
    const auto suggested = suggest_thresholds(kVerdicts, truth, precision);
    ASSERT_EQ(suggested.has_value(), found) << precision;
    EXPECT_EQ(suggested->result.right, best) << precision;
    std::uint64_t accepted = 0;
    for (const CandidateVerdict& v : kVerdicts) {
      accepted += v.plausible && v.inliers >= suggested->min_inliers &&
                          v.log10_false_alarms <= suggested->log10_max_false_alarms
                      ? 1
                      : 0;
    }
    EXPECT_EQ(suggested->result.accepted, accepted) << precision;
  }
}

TEST(RecallAtK, IsCountedByHand) {
  // Image 0 of b by votes: a2 (60, wrong), a1 (50, right), a0. Image 1: a2 (40, wrong), a1 (11, right).
  const std::vector<std::uint32_t> ks{1, 2, 3};
  const std::vector<RecallAtK> recall =
      recall_at_k(kVerdicts, small_truth(), 3, {.min_inliers = 10, .max_false_alarms = 1e-6}, ks);
  ASSERT_EQ(recall.size(), 3u);
  EXPECT_DOUBLE_EQ(recall[0].by_votes, 0);
  EXPECT_DOUBLE_EQ(recall[1].by_votes, 1);
  // Accepted: a0 (40 inliers, right) before a2 for image 0; nothing for image 1.
  EXPECT_DOUBLE_EQ(recall[0].by_verified, 0.5);
  EXPECT_DOUBLE_EQ(recall[2].by_verified, 0.5);
}

TEST(WrongEdges, AreCountedAlongTheRun) {
  std::vector<RecordedEdge> edges(3);
  edges[0].u = VertexId{0}, edges[0].v = VertexId{4};  // a0, b0: right
  edges[1].u = VertexId{2}, edges[1].v = VertexId{4};  // a2, b0: wrong
  edges[2].u = VertexId{3}, edges[2].v = VertexId{6};  // a3, b2: wrong
  EXPECT_EQ(wrong_edges(edges, small_truth(), 4), (std::vector<std::uint64_t>{0, 0, 1, 2}));
  const std::array<NamedMap, 2> maps{NamedMap{"a", {"a0", "a1", "a2", "a3"}}, NamedMap{"b", {"b0", "b1", "b2"}}};
  const Truth graded = Truth::parse("a,b,shared\na0,b0,0.4\na2,b0,0.06\n", maps);
  EXPECT_EQ(wrong_edges(edges, graded, 4), (std::vector<std::uint64_t>{0, 0, 1, 2}));
  EXPECT_EQ(wrong_edges(edges, graded, 4, Error::kNotListed), (std::vector<std::uint64_t>{0, 0, 0, 1}));
}

}  // namespace
}  // namespace mapweld::server::evaluation
