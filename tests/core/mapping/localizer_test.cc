#include "core/mapping/localizer.h"

#include <algorithm>
#include <vector>

#include <gtest/gtest.h>

#include "core/geometry/epipolar_verifier.h"
#include "core/retrieval/voting.h"
#include "tests/core/geometry/two_view_scene.h"
#include "tests/core/mapping/scene_map.h"

namespace mapweld {
namespace {

using test::SceneMap;
using test::TableVerifier;

// Places with a scene each; the map has the first views, queries are the second views.
struct Places {
  SceneMap map;
  std::vector<AppearanceVector> queries;
};
Places make_places(int count) {
  Places places;
  for (int i = 0; i < count; ++i) {
    const auto scene = test::make_scene({.seed = 100 + static_cast<std::uint64_t>(i),
                                         .points = 20 + 5 * i,
                                         .outliers = 10,
                                         .clutter = 60,
                                         .first_word = static_cast<std::uint32_t>(i % 5) * 90});  // words are shared
    places.map.add(scene.a);
    places.queries.push_back(scene.b);
  }
  return places;
}

TEST(Localizer, EqualsExhaustiveVerification) {
  const Places places = make_places(20);
  const EpipolarVerifier verifier;
  MapParameters parameters;
  parameters.verify_top = 1000;
  int found = 0;
  for (const AppearanceVector& query : places.queries) {
    const Localization l = localize(query, places.map, verifier, parameters);
    // Every vertex, verified without a vote.
    std::vector<LocalizationMatch> all;
    for (std::uint32_t v = 0; v < places.map.size(); ++v) {
      const std::uint32_t votes = pair_votes(query, places.map.image(v), VoteRule::kMin);
      const Verification verification = verifier.verify(query, places.map.image(v));
      if (votes < parameters.min_votes) {
        EXPECT_FALSE(verification.accepted) << "min_votes <= min_inliers loses no match";
        continue;
      }
      all.push_back({VertexId{v}, votes, verification.accepted, verification});
    }
    std::ranges::sort(all, [](const LocalizationMatch& a, const LocalizationMatch& b) {
      const auto key = [](const LocalizationMatch& m) {
        return std::tuple(!m.verified, m.verified ? -m.verification.inliers : 0, -static_cast<int>(m.votes), m.vertex);
      };
      return key(a) < key(b);
    });
    ASSERT_EQ(l.matches.size(), all.size());
    for (std::size_t i = 0; i < all.size(); ++i) {
      EXPECT_EQ(l.matches[i].vertex, all[i].vertex);
      EXPECT_EQ(l.matches[i].votes, all[i].votes);
      EXPECT_EQ(l.matches[i].verified, all[i].verified);
      EXPECT_EQ(l.matches[i].verification, all[i].verification);
    }
    EXPECT_EQ(l.funnel.candidates, static_cast<int>(all.size()));
    EXPECT_EQ(l.funnel.verified, static_cast<int>(all.size()));
    EXPECT_EQ(l.status == LocalizationStatus::kNotFound, all.empty() || !all.front().verified);
    found += l.status != LocalizationStatus::kNotFound ? 1 : 0;
  }
  EXPECT_GE(found, 15);
}

TEST(Localizer, FindsThePlaceOfAQuery) {
  const Places places = make_places(12);
  const EpipolarVerifier verifier;
  for (std::uint32_t i = 4; i < places.queries.size(); ++i) {
    const Localization l = localize(places.queries[i], places.map, verifier, {});
    EXPECT_EQ(l.status, LocalizationStatus::kLocalized);
    EXPECT_EQ(l.reason, Reason::kNone);
    ASSERT_FALSE(l.matches.empty());
    EXPECT_EQ(l.matches.front().vertex, VertexId{i});
    EXPECT_EQ(l.funnel.best_inliers, l.matches.front().verification.inliers);
    EXPECT_EQ(l.funnel.needed_inliers, 10);
    EXPECT_EQ(l.funnel.features, static_cast<int>(places.queries[i].appearances.size()));
  }
}

TEST(Localizer, VerifiesTheBestOnly) {
  SceneMap map;
  for (int v = 0; v < 30; ++v) map.add(TableVerifier::image(v, 0, 20 + v));
  TableVerifier verifier;
  verifier.set(100, 29, 11);
  verifier.set(100, 3, 50);  // 23 votes: rank 27
  const AppearanceVector query = TableVerifier::image(100, 0, 60);
  MapParameters parameters;
  parameters.verify_top = 5;
  const Localization l = localize(query, map, verifier, parameters);
  EXPECT_EQ(l.funnel.candidates, 30);
  EXPECT_EQ(l.funnel.verified, 5);
  EXPECT_EQ(l.funnel.best_inliers, 11);
  ASSERT_EQ(l.matches.size(), 30u);
  EXPECT_EQ(l.matches[0].vertex, VertexId{29});
  EXPECT_TRUE(l.matches[0].verified);
  EXPECT_EQ(l.matches[1].vertex, VertexId{28});
  EXPECT_FALSE(l.matches[29].verified);
  EXPECT_EQ(l.matches[29].verification, Verification{});
}

TEST(Localizer, VerifiedMatchesComeByInliersThenVotesThenVertex) {
  SceneMap map;
  for (int v = 0; v < 6; ++v) map.add(TableVerifier::image(v, 0, v < 3 ? 30 : 40));
  TableVerifier verifier;
  for (const int v : {0, 1, 3, 4}) verifier.set(100, v, v == 1 ? 25 : 15);
  const Localization l = localize(TableVerifier::image(100, 0, 50), map, verifier, {});
  std::vector<std::uint32_t> order;
  for (const LocalizationMatch& m : l.matches) order.push_back(to_index(m.vertex));
  EXPECT_EQ(order, (std::vector<std::uint32_t>{1, 3, 4, 0, 5, 2}));
}

TEST(Localizer, ExplainsFailure) {
  SceneMap map;
  for (int v = 0; v < 5; ++v) map.add(TableVerifier::image(v, 0, 30));
  TableVerifier verifier;
  const auto reason = [&](const AppearanceVector& query) {
    const Localization l = localize(query, map, verifier, {});
    EXPECT_EQ(l.status, LocalizationStatus::kNotFound);
    return l.reason;
  };
  EXPECT_EQ(reason({.width_px = 320, .height_px = 240, .appearances = {}}), Reason::kTooFewFeatures);
  EXPECT_EQ(reason(TableVerifier::image(100, 0, 9)), Reason::kTooFewFeatures);
  EXPECT_EQ(reason(TableVerifier::image(100, 500, 40)), Reason::kNoCandidate);
  EXPECT_EQ(reason(TableVerifier::image(100, 28, 40)), Reason::kNoCandidate) << "2 votes are below min_votes";
  EXPECT_EQ(reason(TableVerifier::image(100, 0, 40)), Reason::kTooFewInliers);
  verifier.set(100, 2, 13, Reason::kNotSignificant);
  EXPECT_EQ(reason(TableVerifier::image(100, 0, 40)), Reason::kNotSignificant);
  verifier.set(100, 4, 7, Reason::kInconsistent);
  EXPECT_EQ(reason(TableVerifier::image(100, 0, 40)), Reason::kInconsistent);
}

TEST(Localizer, EmptyMapHasNoCandidate) {
  const Localization l = localize(TableVerifier::image(100, 0, 40), SceneMap{}, TableVerifier{}, {});
  EXPECT_EQ(l.status, LocalizationStatus::kNotFound);
  EXPECT_EQ(l.reason, Reason::kNoCandidate);
  EXPECT_TRUE(l.matches.empty());
}

// A chain of 30 vertices, each with an edge to the one before.
class Doubt : public testing::Test {
 protected:
  Doubt() {
    for (int v = 0; v < 30; ++v) {
      map_.add(TableVerifier::image(v, 0, 40),
               v > 0 && linked_ ? std::vector{VertexId{static_cast<std::uint32_t>(v - 1)}} : std::vector<VertexId>{});
    }
    parameters_.verify_top = 30;
  }
  LocalizationStatus status() const {
    return localize(TableVerifier::image(100, 0, 40), map_, verifier_, parameters_).status;
  }
  bool linked_ = true;
  SceneMap map_;
  TableVerifier verifier_;
  MapParameters parameters_;
};

TEST_F(Doubt, TwoPlacesFarApartAreAmbiguous) {
  verifier_.set(100, 4, 30);
  verifier_.set(100, 20, 25);
  EXPECT_EQ(status(), LocalizationStatus::kAmbiguous);
}

TEST_F(Doubt, APlaceClearlyAheadIsNot) {
  verifier_.set(100, 4, 30);
  verifier_.set(100, 20, 14);
  EXPECT_EQ(status(), LocalizationStatus::kLocalized);
  verifier_.set(100, 20, 15);
  EXPECT_EQ(status(), LocalizationStatus::kAmbiguous);
}

TEST_F(Doubt, NeighboursAreOnePlace) {
  verifier_.set(100, 4, 30);
  verifier_.set(100, 7, 30);
  EXPECT_EQ(status(), LocalizationStatus::kLocalized);
  verifier_.set(100, 10, 30);  // through 7
  EXPECT_EQ(status(), LocalizationStatus::kLocalized);
  verifier_.set(100, 20, 30);
  EXPECT_EQ(status(), LocalizationStatus::kAmbiguous);
}

TEST_F(Doubt, AWeakMatchMayBridge) {
  verifier_.set(100, 4, 60);
  verifier_.set(100, 10, 50);
  EXPECT_EQ(status(), LocalizationStatus::kAmbiguous);
  verifier_.set(100, 7, 12);
  EXPECT_EQ(status(), LocalizationStatus::kLocalized);
}

TEST_F(Doubt, ImagesThatVerifyEachOtherAreOnePlace) {
  verifier_.set(100, 4, 30);
  verifier_.set(100, 20, 25);
  verifier_.set(4, 20, 12);  // an edge that the map lacks
  EXPECT_EQ(status(), LocalizationStatus::kLocalized);
}

TEST(Localizer, EdgesJoinPlacesWhateverTheirNumbers) {
  SceneMap map;
  for (int v = 0; v < 30; ++v) map.add(TableVerifier::image(v, 0, 40));
  TableVerifier verifier;
  verifier.set(100, 2, 30);
  verifier.set(100, 25, 28);
  MapParameters parameters;
  parameters.verify_top = 30;
  const AppearanceVector query = TableVerifier::image(100, 0, 40);
  EXPECT_EQ(localize(query, map, verifier, parameters).status, LocalizationStatus::kAmbiguous);
  map.add(TableVerifier::image(30, 0, 40), {VertexId{2}});
  map.add(TableVerifier::image(31, 0, 40), {VertexId{25}, VertexId{30}});
  EXPECT_EQ(localize(query, map, verifier, parameters).status, LocalizationStatus::kLocalized)
      << "2 - 30 - 31 - 25 are three hops";
}

TEST(Localizer, StatusWords) {
  EXPECT_EQ(to_string(LocalizationStatus::kLocalized), "localized");
  EXPECT_EQ(to_string(LocalizationStatus::kAmbiguous), "ambiguous");
  EXPECT_EQ(to_string(LocalizationStatus::kNotFound), "not_found");
}

}  // namespace
}  // namespace mapweld
