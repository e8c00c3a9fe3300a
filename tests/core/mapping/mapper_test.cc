#include "core/mapping/mapper.h"

#include <vector>

#include <gtest/gtest.h>

#include "core/geometry/epipolar_verifier.h"
#include "tests/core/geometry/two_view_scene.h"
#include "tests/core/mapping/scene_map.h"

namespace mapweld {
namespace {

using test::SceneMap;
using test::TableVerifier;
using Outcome = MappingDecision::Outcome;

TEST(Mapper, TheFirstImageIsInserted) {
  const MappingDecision d = decide(TableVerifier::image(1, 0, 40), SceneMap{}, TableVerifier{}, {});
  EXPECT_EQ(d.outcome, Outcome::kInserted);
  EXPECT_EQ(d.reason, Reason::kNoCandidate);
  EXPECT_TRUE(d.edges.empty());
}

TEST(Mapper, AnImageWithoutFeaturesIsInserted) {
  SceneMap map;
  map.add(TableVerifier::image(0, 0, 40));
  const AppearanceVector blank{.width_px = 320, .height_px = 240, .appearances = {}};
  const MappingDecision d = decide(blank, map, TableVerifier{}, {});
  EXPECT_EQ(d.outcome, Outcome::kInserted);
  EXPECT_EQ(d.reason, Reason::kTooFewFeatures);
  map.add(blank);
  EXPECT_EQ(decide(blank, map, TableVerifier{}, {}).outcome, Outcome::kInserted);
}

TEST(Mapper, EveryVerifiedSimilarImageGetsAnEdge) {
  SceneMap map;
  for (int v = 0; v < 12; ++v) map.add(TableVerifier::image(v, 0, 40));
  TableVerifier verifier;
  verifier.set(100, 3, 20);
  verifier.set(100, 5, 90);
  verifier.set(100, 11, 12);
  verifier.set(100, 7, 80, Reason::kNotSignificant);
  const MappingDecision d = decide(TableVerifier::image(100, 0, 40), map, verifier, {});
  EXPECT_EQ(d.outcome, Outcome::kInserted);
  EXPECT_EQ(d.reason, Reason::kNone);
  ASSERT_EQ(d.edges.size(), 3u);
  EXPECT_EQ(d.edges[0].vertex, VertexId{5});
  EXPECT_EQ(d.edges[1].vertex, VertexId{3});
  EXPECT_EQ(d.edges[2].vertex, VertexId{11});
  EXPECT_EQ(d.edges[0].verification.inliers, 90);
  EXPECT_EQ(d.edges[0].votes, 40u);
}

TEST(Mapper, TooSimilarImagesAreIgnored) {
  SceneMap map;
  for (int v = 0; v < 3; ++v) map.add(TableVerifier::image(v, 0, 40));
  MapParameters parameters;
  parameters.max_inliers = 50;
  TableVerifier verifier;
  verifier.set(100, 0, 12);
  verifier.set(100, 2, 50);
  const AppearanceVector image = TableVerifier::image(100, 0, 40);
  EXPECT_EQ(decide(image, map, verifier, parameters).outcome, Outcome::kInserted) << "at the threshold";
  verifier.set(100, 2, 51);
  const MappingDecision d = decide(image, map, verifier, parameters);
  EXPECT_EQ(d.outcome, Outcome::kIgnored);
  EXPECT_EQ(d.similar_to, VertexId{2});
  EXPECT_EQ(d.inliers, 51);
  EXPECT_TRUE(d.edges.empty());
  verifier.set(100, 2, 51, Reason::kInconsistent);
  EXPECT_EQ(decide(image, map, verifier, parameters).outcome, Outcome::kInserted) << "rejected pairs count for nothing";
}

TEST(Mapper, TwoViewsOfAPlaceGetAnEdgeAndAThirdIsOneTooMany) {
  const EpipolarVerifier verifier;
  SceneMap map;
  for (std::uint64_t i = 0; i < 6; ++i) {
    const auto scene = test::make_scene(
        {.seed = 500 + i, .points = 60, .outliers = 10, .first_word = static_cast<std::uint32_t>(1000 * i)});
    const MappingDecision first = decide(scene.a, map, verifier, {});
    EXPECT_EQ(first.outcome, Outcome::kInserted);
    EXPECT_TRUE(first.edges.empty());
    const VertexId a = map.add(scene.a);
    const MappingDecision second = decide(scene.b, map, verifier, {});
    EXPECT_EQ(second.outcome, Outcome::kInserted);
    ASSERT_EQ(second.edges.size(), 1u);
    EXPECT_EQ(second.edges[0].vertex, a);
    EXPECT_GE(second.edges[0].verification.inliers, 10);
    map.add(scene.b, {a});
    MapParameters strict;
    strict.max_inliers = second.edges[0].verification.inliers - 1;
    const MappingDecision again = decide(scene.b, map, verifier, strict);
    EXPECT_EQ(again.outcome, Outcome::kIgnored) << "the same image once more";
    EXPECT_EQ(again.similar_to, VertexId{to_index(a) + 1});
  }
}

// 70 features never have more than max_inliers matches; a camera at rest is told by what they could have.
TEST(Mapper, ADimViewThatNothingMovesInIsIgnored) {
  const EpipolarVerifier verifier;
  SceneMap map;
  const auto scene = test::make_scene({.seed = 7, .points = 60, .outliers = 10, .clutter = 0});
  const VertexId other = map.add(scene.b);
  const VertexId seen = map.add(scene.a, {other});
  const MappingDecision d = decide(scene.a, map, verifier, {});
  EXPECT_EQ(d.outcome, Outcome::kIgnored);
  EXPECT_EQ(d.similar_to, seen);
  EXPECT_GT(d.inliers, 30);
  EXPECT_LE(d.inliers, MapParameters{}.max_inliers);
  EXPECT_TRUE(d.edges.empty());

  MapParameters keep_all;
  keep_all.max_inliers = kUnlimitedInliers;
  const MappingDecision kept = decide(scene.a, map, verifier, keep_all);
  EXPECT_EQ(kept.outcome, Outcome::kInserted);
  EXPECT_EQ(kept.edges.size(), 2u);
}

}  // namespace
}  // namespace mapweld
