// What a map learns of its camera, on made-up images, against the definition counted out plainly.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include <gtest/gtest.h>

#include "core/geometry/epipolar_verifier.h"
#include "core/mapping/mapper.h"
#include "core/mapping/static_content.h"
#include "tests/core/geometry/signed_scene.h"
#include "tests/core/mapping/scene_map.h"

namespace mapweld {
namespace {

using test::Bits;
using test::SceneMap;

constexpr std::uint32_t kFirstWord = 5'000'000;  // of what the camera carries

// A feature on the grid, in an image of 320 x 240.
Appearance feature(std::uint32_t word, float x_px, float y_px, Signature signature) {
  return {WordId{word}, std::round(x_px * 8) / 8, std::round(y_px * 8) / 8, 4, 45, signature};
}

// Features of its own at places of its own.
AppearanceVector clutter(std::uint64_t seed, int features) {
  Bits random(seed);
  AppearanceVector image{320, 240, {}};
  for (int k = 0; k < features; ++k) {
    const auto x = static_cast<float>(random.below(320));
    const auto y = static_cast<float>(random.below(200));
    image.appearances.push_back(feature(random.below(1'000'000), x, y, random.signature()));
  }
  std::ranges::sort(image.appearances);
  return image;
}

// Adds the k-th to (k + count - 1)-th of what the camera carries, at the lower edge, each a little different every
// time.
void add_carried(AppearanceVector& image, int first, int count, std::uint64_t seed, int bits = 4) {
  Bits own(seed + 100'000);
  for (int k = first; k < first + count; ++k) {
    Bits same(9'000 + static_cast<std::uint64_t>(k));
    const float x = 10 + 7.0f * static_cast<float>(k) + 0.5f * static_cast<float>(own.below(2));
    const float y = 210 + static_cast<float>(k * 7 % 19);
    image.appearances.push_back(
        feature(kFirstWord + static_cast<std::uint32_t>(k), x, y, own.near(same.signature(), bits)));
  }
  std::ranges::sort(image.appearances);
}

AppearanceVector whole(const AppearanceVector& image) {
  AppearanceVector all{image.width_px, image.height_px, image.appearances};
  all.appearances.insert(all.appearances.end(), image.static_appearances.begin(), image.static_appearances.end());
  std::ranges::sort(all.appearances);
  return all;
}

bool is_same(const Appearance& p, const Appearance& q) {
  if (std::hypot(p.x_px - q.x_px, p.y_px - q.y_px) > 0.004f * 400) return false;
  int bits = 0;
  for (std::size_t i = 0; i < 4; ++i) bits += __builtin_popcount(p.signature.bits[i] ^ q.signature.bits[i]);
  return bits <= 20 && std::abs(p.angle_deg - q.angle_deg) <= 15;
}

// By the definition: every feature with every feature, neighbours by hops.
std::vector<Appearance> expected_static(const AppearanceVector& image, const std::vector<VertexId>& linked,
                                        const SceneMap& map) {
  std::uint32_t step = 1;
  while (map.size() >= std::size_t{32} * step) step *= 2;
  std::vector<int> images(image.appearances.size(), 0);
  std::vector<VertexId> teachers;
  for (std::uint32_t v = 0; v < map.size(); v += step) {
    const VertexId vertex{v};
    const auto near = [&](VertexId other, int hops) { return map.hops(other, vertex, hops).has_value(); };
    if (std::ranges::any_of(linked, [&](VertexId other) { return near(other, 1); })) continue;
    if (std::ranges::any_of(teachers, [&](VertexId other) { return near(other, 2); })) continue;
    const AppearanceVector other = whole(map.image(v));
    std::vector<std::size_t> common;
    for (std::size_t i = 0; i < images.size(); ++i) {
      if (std::ranges::any_of(other.appearances, [&](const auto& q) { return is_same(image.appearances[i], q); })) {
        common.push_back(i);
      }
    }
    const std::size_t fewer = std::min(images.size(), other.appearances.size());
    if (common.empty() || static_cast<double>(common.size()) > 0.6 * static_cast<double>(fewer)) continue;
    teachers.push_back(vertex);
    for (const std::size_t i : common) ++images[i];
  }
  std::vector<Appearance> found;
  for (std::size_t i = 0; i < images.size(); ++i) {
    if (images[i] >= 4) found.push_back(image.appearances[i]);
  }
  return found;
}

TEST(LearnedStatic, IsWhatTheDefinitionSays) {
  std::size_t all = 0;
  for (std::uint64_t seed = 0; seed < 12; ++seed) {
    Bits random(seed);
    SceneMap map;
    const std::uint32_t images = 5 + random.below(90);
    for (std::uint32_t v = 0; v < images; ++v) {
      AppearanceVector image = clutter(1'000 * seed + v, 20 + static_cast<int>(random.below(60)));
      // Some images show less of it, some nothing, and some look nearly the same.
      if (random.below(4) != 0) {
        add_carried(image, static_cast<int>(random.below(10)), 5 + static_cast<int>(random.below(15)), 1'000 * seed + v,
                    static_cast<int>(2 + random.below(10)));
      }
      if (v > 0 && random.below(6) == 0) image = whole(map.image(random.below(v)));
      std::vector<VertexId> linked;
      for (std::uint32_t u = v > 2 ? v - 2 : 0; u < v; ++u) {
        if (random.below(3) == 0) linked.push_back(VertexId{u});
      }
      const std::vector<Appearance> expected = expected_static(image, linked, map);
      const AppearanceVector before = image;
      EXPECT_EQ(learn_static(image, linked, map), !expected.empty());
      EXPECT_EQ(image.static_appearances, expected) << "seed " << seed << ", image " << v;
      EXPECT_EQ(whole(image), before);
      all += expected.size();
      map.add(image, linked);
    }
  }
  EXPECT_GT(all, 500u);
}

TEST(LearnedStatic, FourImagesTeachAndThreeDoNot) {
  for (const int teachers : {3, 4}) {
    SceneMap map;
    for (int v = 0; v < teachers; ++v) {
      AppearanceVector image = clutter(static_cast<std::uint64_t>(v), 100);
      add_carried(image, 0, 12, static_cast<std::uint64_t>(v));
      map.add(image);
    }
    AppearanceVector image = clutter(77, 100);
    add_carried(image, 0, 12, 77);
    EXPECT_EQ(learn_static(image, {}, map), teachers == 4);
    EXPECT_EQ(image.static_appearances.size(), teachers == 4 ? 12u : 0u);
    EXPECT_EQ(image.appearances.size(), teachers == 4 ? 100u : 112u);
    EXPECT_TRUE(std::ranges::all_of(image.static_appearances,
                                    [](const Appearance& a) { return to_index(a.word) >= kFirstWord; }));
  }
}

TEST(LearnedStatic, ThoseWhoAreNeighboursOrShowTheSameViewTeachNothing) {
  const auto image_with = [](std::uint64_t seed, int own, int carried) {
    AppearanceVector image = clutter(seed, own);
    add_carried(image, 0, carried, seed);
    return image;
  };
  SceneMap chain, all_new, same_view;
  for (std::uint64_t v = 0; v < 8; ++v) {
    chain.add(image_with(v, 100, 12), v == 0 ? std::vector<VertexId>{} : std::vector{VertexId{0}});
    all_new.add(image_with(v, 100, 12));
    same_view.add(image_with(v, 10, 20));
  }
  AppearanceVector image = image_with(77, 100, 12);
  EXPECT_FALSE(learn_static(image, {}, chain)) << "all are two hops apart";
  EXPECT_TRUE(learn_static(image, {}, all_new));
  image = image_with(77, 100, 12);
  EXPECT_TRUE(learn_static(image, std::vector{VertexId{1}, VertexId{3}, VertexId{5}}, all_new)) << "five are left";
  image = image_with(77, 100, 12);
  EXPECT_FALSE(
      learn_static(image, std::vector{VertexId{1}, VertexId{2}, VertexId{3}, VertexId{4}, VertexId{5}}, all_new));
  image = image_with(77, 10, 20);
  EXPECT_FALSE(learn_static(image, {}, same_view));
}

TEST(LearnedStatic, WhatIsKnownIsSetApartInEveryImageWithoutEdges) {
  SceneMap map;
  for (std::uint64_t v = 0; v < 100; ++v) {
    AppearanceVector image = clutter(v, 100);
    add_carried(image, 0, 12, v);
    learn_static(image, {}, map);
    EXPECT_EQ(image.static_appearances.size(), v < 4 ? 0u : 12u);
    map.add(image);
  }
  AppearanceVector query = clutter(777, 100);
  add_carried(query, 4, 30, 777);  // eight known ones
  const AppearanceVector split = with_known_static(query, map);
  EXPECT_EQ(split.static_appearances.size(), 8u);
  EXPECT_EQ(split.appearances.size(), 122u);
  EXPECT_EQ(whole(split), query);
  EXPECT_EQ(with_known_static(clutter(778, 100), map), clutter(778, 100));
  EXPECT_EQ(with_known_static(query, SceneMap{}), query);
}

TEST(LearnedStatic, ADecisionIsAboutTheRest) {
  const EpipolarVerifier verifier;
  SceneMap map;
  for (std::uint64_t v = 0; v < 12; ++v) {
    AppearanceVector image = clutter(v, 100);
    add_carried(image, 0, 30, v);
    const MappingDecision decision = decide(image, map, verifier, {});
    ASSERT_EQ(decision.outcome, MappingDecision::Outcome::kInserted);
    EXPECT_TRUE(decision.edges.empty());
    EXPECT_EQ(whole(decision.image), image);
    EXPECT_EQ(decision.image.static_appearances.size(), v < 4 ? 0u : 30u);
    map.add(decision.image);
  }
  const auto scene = test::signed_scene({.seed = 5, .points = 60, .outliers = 40}, 30, 4);
  for (AppearanceVector image : {scene.a, scene.b}) {
    add_carried(image, 0, 30, 300);
    const MappingDecision decision = decide(image, map, verifier, {});
    ASSERT_EQ(decision.outcome, MappingDecision::Outcome::kInserted);
    EXPECT_EQ(decision.image.static_appearances.size(), 30u);
    std::vector<VertexId> linked;
    for (const LocalizationMatch& edge : decision.edges) {
      linked.push_back(edge.vertex);
      for (const auto& [i, j] : edge.verification.inlier_matches) {
        EXPECT_LT(i, decision.image.appearances.size());
        EXPECT_LT(j, map.image(to_index(edge.vertex)).appearances.size());
      }
    }
    EXPECT_EQ(linked, map.size() == 12 ? std::vector<VertexId>{} : std::vector{VertexId{12}});
    map.add(decision.image, linked);
  }
}

TEST(StaticShare, CountsTheCellsThatTwoImagesHaveSomethingIn) {
  EXPECT_EQ(static_share({}), 0);
  std::vector<AppearanceVector> images(3, AppearanceVector{320, 240, {}});
  images[2] = {640, 480, {}};
  const auto put = [&](std::size_t image, float x_px, float y_px) {
    images[image].static_appearances.push_back(feature(1, x_px, y_px, {}));
  };
  put(0, 5, 5);
  put(0, 6, 6);
  EXPECT_EQ(static_share(images), 0) << "twice in one image";
  put(1, 19, 19);
  EXPECT_DOUBLE_EQ(static_share(images), 1.0 / 192);
  put(0, 319, 239);
  put(2, 639, 479);
  EXPECT_DOUBLE_EQ(static_share(images), 2.0 / 192);
}

}  // namespace
}  // namespace mapweld
