#include "tests/evaluation/guard/guard_counts.h"

#include <memory>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/evaluation/guard/guard_prefixes.h"
#include "tests/evaluation/guard/photograph_truth.h"
#include "tests/evaluation/guard/reliability.h"

namespace mapweld::evaluation {
namespace {

// Two maps of 8 and 6 images without a feature, linked along their order; an edge for each (u, v, truth).
struct Joint {
  std::uint32_t u, v;
  Truth truth;
};
JudgedMerge merge_with(const std::vector<Joint>& joints) {
  JudgedMerge judged;
  const auto image = std::make_shared<const AppearanceVector>();
  judged.merge.a.vertices.assign(8, image);
  judged.merge.b.vertices.assign(6, image);
  for (std::uint32_t v = 0; v + 1 < 8; ++v) judged.merge.a.inner_edges.push_back({VertexId{v}, VertexId{v + 1}, {}});
  for (std::uint32_t v = 0; v + 1 < 6; ++v) judged.merge.b.inner_edges.push_back({VertexId{v}, VertexId{v + 1}, {}});
  judged.inner = judged.merge.inner_edges();
  judged.inner_truth.assign(judged.inner.size(), Truth::kUnknown);
  judged.images.assign(14, 1);
  for (const Joint& joint : joints) {
    MergeEdge edge;
    edge.u = VertexId{joint.u};
    edge.v = VertexId{8 + joint.v};
    edge.verification.accepted = true;
    judged.merge.inter_edges.push_back(edge);
    judged.inter_truth.push_back(joint.truth);
  }
  return judged;
}

GuardOptions all_confirmed() {
  GuardOptions options;
  options.min_confidence = 0;
  return options;
}

TEST(GuardCounts, ImagesCountWithThoseThatTheyStandFor) {
  JudgedMerge judged = merge_with({{0, 0, Truth::kRight}, {0, 1, Truth::kUnknown}, {5, 5, Truth::kWrong}});
  judged.images[0] = 4;
  const GuardCounts counts = run_guard(judged, all_confirmed()).counts;
  EXPECT_EQ(counts.joined.a, 4u);
  EXPECT_EQ(counts.joined.b, 2u);
  EXPECT_EQ(counts.joined_by_verified.both(), 6u);
  EXPECT_EQ(counts.confirmed.wrong, 1u);
  EXPECT_EQ(counts.confirmed.not_wrong(), 2u);
}

TEST(GuardCounts, AWrongJoinIsAClusterWithoutARightEdge) {
  // (1, 1) lies within two links of the right (0, 0); (5, 5) and (6, 4) are one cluster of their own, (7, 1) is
  // another.
  const auto judged = merge_with({{0, 0, Truth::kRight},
                                  {1, 1, Truth::kWrong},
                                  {5, 5, Truth::kWrong},
                                  {6, 4, Truth::kWrong},
                                  {7, 1, Truth::kWrong}});
  EXPECT_EQ(run_guard(judged, all_confirmed()).counts.wrong_joins, 2u);
  GuardOptions none;
  none.min_confidence = 1;
  const GuardCounts counts = run_guard(judged, none).counts;
  EXPECT_EQ(counts.wrong_joins, 0u);
  EXPECT_EQ(counts.wrong_joins_verified, 2u);
  EXPECT_EQ(counts.joined.both(), 0u);
}

TEST(GuardPrefixes, SharesAreOfWhatIsVerifiedSoFar) {
  const auto judged = merge_with({{0, 0, Truth::kRight}, {1, 1, Truth::kRight}, {2, 2, Truth::kWrong}});
  const auto figures = guard_prefixes(judged, judged.merge.inter_edges, 3, all_confirmed(), true);
  ASSERT_EQ(figures.prefixes.size(), 3u);
  EXPECT_EQ(figures.prefixes[0].joined_by_verified, 2u);
  EXPECT_EQ(figures.prefixes[2].joined_by_verified, 4u);
  EXPECT_EQ(figures.prefixes[2].joined, 6u);
  EXPECT_EQ(figures.prefixes[2].joined_rightly, 4u);
  EXPECT_EQ(figures.wrong_confirmed, 1u);
  EXPECT_DOUBLE_EQ(figures.least_share, 1);
  EXPECT_DOUBLE_EQ(figures.largest_fall, 0);
  EXPECT_EQ(figures.not_as_fresh, 0u);
  GuardOptions none;
  none.min_confidence = 1;
  const auto without = guard_prefixes(judged, judged.merge.inter_edges, 3, none, false);
  EXPECT_DOUBLE_EQ(without.least_share, 0);
  EXPECT_EQ(without.below_70_percent, 3u);
}

TEST(Reliability, ACaseWeighsAtMostSoMuch) {
  const auto judged = merge_with({{0, 0, Truth::kRight}, {1, 1, Truth::kWrong}, {2, 2, Truth::kUnknown}});
  std::vector<GuardVerdict> verdicts(3);
  for (GuardVerdict& verdict : verdicts) verdict.confidence = 0.97;
  Reliability reliability(1);
  reliability.add(judged, verdicts, false);
  const auto& bins = reliability.bins();
  const auto bin = std::ranges::find_if(bins, [](const ReliabilityBin& b) { return b.edges > 0; });
  ASSERT_NE(bin, bins.end());
  EXPECT_DOUBLE_EQ(bin->from, 0.95);
  EXPECT_EQ(bin->edges, 2u);
  EXPECT_EQ(bin->right, 1u);
  EXPECT_DOUBLE_EQ(bin->weight, 1);
  EXPECT_DOUBLE_EQ(bin->share_right(), 0.5);
  EXPECT_NEAR(bin->mean_confidence(), 0.97, 1e-12);
}

TEST(Reliability, FullConfidenceHasABin) {
  const auto judged = merge_with({{0, 0, Truth::kRight}});
  Reliability reliability;
  reliability.add(judged, std::vector<GuardVerdict>(1), true);
  EXPECT_EQ(reliability.bins().back().edges, 1u);
}

TEST(PhotographTruth, BuildingsShareNothingAndNamesOfStoreysDecide) {
  PhotographTruth truth;
  const auto of = [&](const char* a, const char* x, const char* b, const char* y) { return truth.of({a, x}, {b, y}); };
  EXPECT_EQ(of("office-two-rings/a", "x.png", "tower-storeys/storey-04/walk-1", "1.jpg"), Truth::kWrong);
  EXPECT_EQ(of("office-two-rings/a", "x.png", "office-two-runs/live", "1.png"), Truth::kUnknown);
  EXPECT_EQ(of("places-two-visits/studio/A", "1.jpg", "places-two-visits/magasin/B", "1.jpg"), Truth::kWrong);
  EXPECT_EQ(of("places-two-visits/studio/B", "1.jpg", "places-two-visits/studio/A", "1.jpg"), Truth::kRight);
  EXPECT_EQ(of("twin-storeys/storey-3/part-b", "0202.jpg", "twin-storeys/storey-2/part-a", "0201.jpg"), Truth::kWrong);
  EXPECT_EQ(of("twin-storeys/storey-2/part-b", "0202.jpg", "twin-storeys/storey-2/part-a", "0201.jpg"), Truth::kRight);
  EXPECT_EQ(of("twin-storeys/storey-2/part-a", "0001.jpg", "twin-storeys/storey-2/part-a", "0025.jpg"), Truth::kRight);
  EXPECT_EQ(of("tower-storeys/storey-04/walk-1", "1.jpg", "tower-storeys/storey-04/walk-1", "2.jpg"), Truth::kUnknown);
}

}  // namespace
}  // namespace mapweld::evaluation
