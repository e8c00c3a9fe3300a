#include "core/guard/guarded_map.h"

#include <algorithm>
#include <cstdint>
#include <memory>
#include <numeric>
#include <random>
#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>

#include "core/guard/links.h"

namespace mapweld {
namespace {

// Two storeys of `each` images on one drive each: an image shares most of its features with the next ones, and a few,
// the same all along, with every image of the other storey.
class Storeys {
 public:
  explicit Storeys(std::uint32_t each) : each_(each) {
    for (std::uint32_t v = 0; v < 2 * each; ++v) {
      AppearanceVector image{.width_px = 320, .height_px = 240, .appearances = {}};
      for (std::uint32_t f = 0; f < 100; ++f) {
        const std::uint32_t place = f * 37 % 100;
        const std::uint32_t word = f < kCommon ? f : 100 + v * 100 + f;
        image.appearances.push_back({WordId{word}, 16.0f + 32 * static_cast<float>(place % 10),
                                     12.0f + 24 * static_cast<float>(place / 10), 4, 0});
      }
      images_.push_back(std::make_shared<const AppearanceVector>(std::move(image)));
    }
    for (std::uint32_t s = 0; s < 2; ++s) {
      for (std::uint32_t i = 0; i < each; ++i) {
        for (std::uint32_t back = 1; back <= 3 && back <= i; ++back) {
          join(s * each + i - back, s * each + i, 0, static_cast<std::uint16_t>(80 - 15 * back));
        }
      }
    }
    inner_ = edges.size();
  }
  void join_storeys() {
    for (std::uint32_t i = 0; i < each_; ++i) join(i, each_ + i, 0, kCommon);
  }
  void join(std::uint32_t u, std::uint32_t v, std::uint16_t first, std::uint16_t last) {
    VerifiedEdge edge{VertexId{u}, VertexId{v}, {}};
    for (std::uint16_t i = first; i < last; ++i) edge.inlier_matches.emplace_back(i, i);
    edges.push_back(edge);
  }
  GuardedMap map(const std::vector<VerifiedEdge>& of) const {
    return {2 * each_, [this](std::uint32_t v) { return images_.at(v); }, of, {}};
  }
  std::size_t inner() const { return inner_; }

  static constexpr std::uint16_t kCommon = 20;
  std::vector<VerifiedEdge> edges;

 private:
  std::uint32_t each_;
  std::size_t inner_ = 0;
  std::vector<std::shared_ptr<const AppearanceVector>> images_;
};

TEST(GuardedMap, LinksADriveAndNotItsDouble) {
  Storeys storeys(30);
  storeys.join_storeys();
  const GuardedMap map = storeys.map(storeys.edges);
  for (std::size_t e = 0; e < storeys.edges.size(); ++e) {
    EXPECT_EQ(map.verdicts()[e].confirmed(), e < storeys.inner()) << e;
  }
  for (std::uint32_t v = 0; v < 60; ++v) {
    for (const Link& link : map.passing()[v]) EXPECT_EQ(link.to < 30, v < 30);
  }
}

TEST(GuardedMap, AnImageWithoutGoodViewsOfItsOwnLeadsNobodyIntoTheDouble) {
  Storeys storeys(30);
  std::erase_if(storeys.edges, [](const VerifiedEdge& e) { return to_index(e.v) == 59; });
  const std::size_t right = storeys.edges.size();
  storeys.join(58, 59, 0, 26);  // dim: what it sees of its own storey is hardly fuller than what the double shows
  for (std::uint32_t v = 8; v <= 14; ++v) storeys.join(v, 59, 0, Storeys::kCommon);
  for (std::uint32_t v = 8; v <= 14; ++v) storeys.join(v, 58, 0, Storeys::kCommon);
  const GuardedMap map = storeys.map(storeys.edges);
  for (std::size_t e = 0; e < storeys.edges.size(); ++e) {
    if (e == right) continue;  // 58 and 59: doubtful either way
    EXPECT_EQ(map.verdicts()[e].confirmed(), e < right) << e;
  }
}

TEST(GuardedMap, SuccessiveViewsAreNeighboursWhereTheWayShowsInTheEdges) {
  constexpr std::uint32_t kEach = 30;
  Storeys none(kEach);
  none.edges.clear();
  Storeys drive = none, collection = none;
  for (std::uint32_t v = 1; v < kEach; ++v) drive.join(v - 1, v, 0, 28);  // faint: a turn on the spot
  for (std::uint32_t v = 0; v < kEach; ++v) collection.join(v, kEach + v * 7 % kEach, 0, 28);
  collection.join(3, 4, 0, 28);  // as it happens
  drive.join(4, 40, 0, 28);      // as faint, and not on the way
  const auto driven = drive.map(drive.edges).verdicts(), collected = collection.map(collection.edges).verdicts();
  for (std::size_t e = 0; e < driven.size(); ++e) {
    EXPECT_EQ(driven[e].evidence.signs.on_the_way > 3, e + 1 < driven.size()) << e;
    EXPECT_EQ(driven[e].confirmed(), e + 1 < driven.size()) << e;
  }
  for (const GuardVerdict& verdict : collected) EXPECT_LT(verdict.evidence.signs.on_the_way, 1);
}

TEST(GuardedMap, TheOrderOfTheEdgesDoesNotMatter) {
  Storeys storeys(20);
  storeys.join_storeys();
  storeys.join(3, 15, 0, 45);
  const auto expected = storeys.map(storeys.edges).verdicts();
  std::vector<std::size_t> order(storeys.edges.size());
  std::iota(order.begin(), order.end(), 0u);
  std::mt19937_64 random(1);
  for (int shuffle = 0; shuffle < 10; ++shuffle) {
    std::ranges::shuffle(order, random);
    std::vector<VerifiedEdge> edges;
    for (const std::size_t i : order) edges.push_back(storeys.edges[i]);
    const auto verdicts = storeys.map(edges).verdicts();
    for (std::size_t k = 0; k < order.size(); ++k) ASSERT_EQ(verdicts[k], expected[order[k]]);
  }
}

TEST(GuardedMap, RefusesEdgesThatAreNotItsOwn) {
  const Storeys storeys(5);
  EXPECT_THROW(storeys.map({{VertexId{0}, VertexId{10}, {{0, 0}}}}), std::invalid_argument);
  EXPECT_THROW(storeys.map({{VertexId{3}, VertexId{3}, {{0, 0}}}}), std::invalid_argument);
  EXPECT_THROW(storeys.map({{VertexId{0}, VertexId{1}, {{0, 100}}}}), std::invalid_argument);
}

TEST(FullestLinks, AreTheFullestOfEitherEnd) {
  // A star: vertex 0 keeps its two fullest; the others keep their only one, which makes it a link of 0 as well.
  const LinkLists links = fullest_links(5, {{0, 1, 1.0, 7}, {0, 2, 3.0, 7}, {0, 3, 2.0, 7}, {3, 4, 9.0, 8}}, 2);
  EXPECT_EQ(links[0], (std::vector<Link>{{1, 7}, {2, 7}, {3, 7}}));
  EXPECT_EQ(links[3], (std::vector<Link>{{0, 7}, {4, 8}}));
  const LinkLists one = fullest_links(4, {{0, 1, 1.0, 7}, {0, 2, 1.0, 7}, {1, 2, 1.0, 7}}, 1);
  EXPECT_EQ(one[0], (std::vector<Link>{{1, 7}, {2, 7}})) << "ties: 0 and 2 keep their lower neighbour";
  EXPECT_TRUE(one[3].empty());
}

}  // namespace
}  // namespace mapweld
