// What is in every picture of a camera is learnt, and joins nothing: rendered drives through two buildings that share
// nothing, with the real extractor, vocabulary, mapper and verifier, every kind of overlay laid over them.
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <opencv2/core/mat.hpp>
#include <opencv2/imgproc.hpp>

#include "core/guard/guarded_map.h"
#include "core/mapping/localizer.h"
#include "tests/support/overlays.h"
#include "tests/support/rendered_merge.h"
#include "tests/support/sample_maps.h"
#include "tests/support/trajectory.h"

namespace mapweld::rendered {
namespace {

constexpr int kImages = 24;  // of each building
constexpr std::uint64_t kFirst = 1;
constexpr std::uint64_t kSecond = 3;

const Vocabulary& vocabulary() {
  static const auto shipped = shipped_vocabulary();
  return *shipped;
}

struct Building {
  RenderedWorld world;
  std::vector<Pose> poses;
  explicit Building(std::uint64_t seed)
      : world({.corridors = 1, .corridor_length_m = 8, .seed = seed, .catalogue_seed = seed}),
        poses(trajectory(world, {.n_images = kImages, .seed = seed})) {}
};

const Building& building(std::uint64_t seed) {
  static std::vector<std::unique_ptr<Building>> built(4);
  if (!built.at(seed)) built[seed] = std::make_unique<Building>(seed);
  return *built[seed];
}

std::vector<AppearanceVector> images_of(std::uint64_t seed, std::optional<Overlay> overlay) {
  const Building& b = building(seed);
  return see(b.world, b.poses, conditions_of_a(), 100 * seed, vocabulary(), 2, overlay);
}

// The images without overlay, but for the features that it would cover.
std::vector<AppearanceVector> uncovered_of(std::uint64_t seed, Overlay overlay) {
  std::vector<AppearanceVector> images = images_of(seed, {});
  for (std::size_t i = 0; i < images.size(); ++i) {
    const cv::Mat covered =
        covered_by(overlay, {images[i].width_px, images[i].height_px}, static_cast<int>(100 * seed + i));
    std::erase_if(images[i].appearances, [&](const Appearance& p) {
      return covered.at<std::uint8_t>(static_cast<int>(p.y_px), static_cast<int>(p.x_px)) != 0;
    });
  }
  return images;
}

// Edges within the first building, within the second, and between the two, in one map of all.
struct Edges {
  int first = 0, second = 0, between = 0;
  int confirmed_between = 0;  // by what the map says of itself
  MadeMap map;
};
Edges edges_of_one_map(const std::vector<AppearanceVector>& first, const std::vector<AppearanceVector>& second) {
  std::vector<AppearanceVector> all = first;
  all.insert(all.end(), second.begin(), second.end());
  const MadeMap map = make_map(all);
  std::vector<bool> is_second(map.vertices.size());
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (map.vertex_of_image[i] != MadeMap::kIgnored) is_second[map.vertex_of_image[i]] = i >= first.size();
  }
  Edges edges;
  for (const VerifiedEdge& e : map.inner_edges) {
    const bool u = is_second[to_index(e.u)];
    const bool v = is_second[to_index(e.v)];
    ++(u != v ? edges.between : u ? edges.second : edges.first);
  }
  const GuardedMap judged(static_cast<std::uint32_t>(map.vertices.size()),
                          [&](std::uint32_t v) { return map.vertices[v]; }, map.inner_edges, {});
  for (std::size_t e = 0; e < map.inner_edges.size(); ++e) {
    const VerifiedEdge& edge = map.inner_edges[e];
    const bool is_between = is_second[to_index(edge.u)] != is_second[to_index(edge.v)];
    edges.confirmed_between += is_between && judged.verdicts()[e].confirmed() ? 1 : 0;
  }
  edges.map = map;
  return edges;
}

// What a map of the images of both buildings has marked.
struct Marked {
  int images = 0;      // of which something is static
  int features = 0;    // static ones of all
  int of_overlay = 0;  // of them, that lie within some pixels of it
};
Marked marked_in(const MadeMap& map, Overlay overlay) {
  Marked marked;
  for (std::size_t i = 0; i < map.vertex_of_image.size(); ++i) {
    if (map.vertex_of_image[i] == MadeMap::kIgnored) continue;
    const AppearanceVector& image = *map.vertices[map.vertex_of_image[i]];
    if (image.static_appearances.empty()) continue;
    const std::uint64_t frame = i < kImages ? 100 * kFirst + i : 100 * kSecond + i - kImages;
    cv::Mat covered = covered_by(overlay, {image.width_px, image.height_px}, static_cast<int>(frame));
    cv::dilate(covered, covered, cv::getStructuringElement(cv::MORPH_ELLIPSE, {17, 17}));
    ++marked.images;
    for (const Appearance& p : image.static_appearances) {
      ++marked.features;
      marked.of_overlay += covered.at<std::uint8_t>(static_cast<int>(p.y_px), static_cast<int>(p.x_px)) != 0 ? 1 : 0;
    }
  }
  return marked;
}

class StaticContent : public ::testing::TestWithParam<Overlay> {};

TEST_P(StaticContent, JoinsNoTwoBuildingsAndLeavesEachItsEdges) {
  static const Edges plain = edges_of_one_map(images_of(kFirst, {}), images_of(kSecond, {}));
  ASSERT_GE(plain.first, 40);
  ASSERT_GE(plain.second, 40);
  ASSERT_EQ(plain.between, 0);
  ASSERT_EQ(marked_in(plain.map, GetParam()).images, 0);
  const Overlay kind = GetParam();
  const Edges visible = edges_of_one_map(uncovered_of(kFirst, kind), uncovered_of(kSecond, kind));
  const Edges edges = edges_of_one_map(images_of(kFirst, kind), images_of(kSecond, kind));
  EXPECT_LE(edges.between, 1);
  EXPECT_EQ(edges.confirmed_between, 0);
  EXPECT_GE(edges.first + edges.second, (visible.first + visible.second) * 8 / 10)
      << "without overlay " << plain.first + plain.second;
  const Marked marked = marked_in(edges.map, kind);
  EXPECT_GE(marked.images, 5) << "each building is nearly one neighbourhood, so that few images teach";
  EXPECT_GE(marked.of_overlay, marked.features * 9 / 10);
  RecordProperty("marked_images", marked.images);
  RecordProperty("marked_features", marked.features);
  RecordProperty("marked_of_overlay", marked.of_overlay);
  RecordProperty("within", edges.first + edges.second);
  RecordProperty("within_where_not_covered", visible.first + visible.second);
  RecordProperty("within_without_overlay", plain.first + plain.second);
}

INSTANTIATE_TEST_SUITE_P(Kinds, StaticContent, ::testing::ValuesIn(kOverlays),
                         [](const auto& kind) { return std::string(to_string(kind.param)); });

}  // namespace
}  // namespace mapweld::rendered
