// The verifier on real photographs, by the shipped vocabulary: nothing of one place in another, and of two visits to
// one place what the truth says.
#include "tests/core/geometry/photographs.h"

#include <algorithm>
#include <cstdlib>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "core/geometry/epipolar_verifier.h"

namespace mapweld {
namespace {

using test::Photograph;
using test::photographs;

#define REQUIRE_PHOTOGRAPHS(folder)                                                      \
  do {                                                                                   \
    if (photographs(folder).empty())                                                     \
      GTEST_SKIP() << "photographs of " << (folder) << " are not here (MAPWELD_PHOTOS)"; \
  } while (false)

struct Accepted {
  int a = 0;
  int b = 0;
  int inliers = 0;
};

std::vector<Accepted> accepted_pairs(const std::vector<Photograph>& a, const std::vector<Photograph>& b) {
  const EpipolarVerifier verifier;
  std::vector<Accepted> accepted;
  for (const Photograph& p : a) {
    for (const Photograph& q : b) {
      const Verification v = verifier.verify(p.appearances, q.appearances);
      if (!v.accepted) continue;
      accepted.push_back({p.number, q.number, v.inliers});
    }
  }
  return accepted;
}

TEST(Photographs, DifferentPlacesAreNeverAccepted) {
  const std::vector<std::vector<std::string>> places = {{"corridor-two-laps/lap-1", "corridor-two-laps/lap-2"},
                                                        {"office-two-runs/reference"},
                                                        {"places-two-visits/magasin/A", "places-two-visits/magasin/B"},
                                                        {"places-two-visits/studio/A", "places-two-visits/studio/B"}};
  for (const auto& folders : places) {
    for (const std::string& folder : folders) REQUIRE_PHOTOGRAPHS(folder);
  }
  for (std::size_t i = 0; i < places.size(); ++i) {
    for (std::size_t j = i + 1; j < places.size(); ++j) {
      for (const std::string& p : places[i]) {
        for (const std::string& q : places[j]) {
          EXPECT_EQ(accepted_pairs(photographs(p), photographs(q)).size(), 0u) << p << " and " << q;
        }
      }
    }
  }
}

TEST(Photographs, TwoLapsOfACorridorMeetWhereTheTruthSays) {
  REQUIRE_PHOTOGRAPHS("corridor-two-laps/lap-1");
  REQUIRE_PHOTOGRAPHS("corridor-two-laps/lap-2");
  const auto same_place = test::corridor_same_place();
  ASSERT_FALSE(same_place.empty());
  // The truth is narrow: neighbours of a listed pair often match as well.
  const auto near = [&](const Accepted& pair) {
    return std::ranges::any_of(
        same_place, [&](const auto& s) { return std::abs(s.first - pair.a) <= 2 && std::abs(s.second - pair.b) <= 2; });
  };
  const auto accepted = accepted_pairs(photographs("corridor-two-laps/lap-1"), photographs("corridor-two-laps/lap-2"));
  EXPECT_GE(accepted.size(), 150u);
  // Its two straight corridors look alike, and the careful matcher joins 20 pairs across them (of 222): no pair alone
  // tells; a guard has to.
  const auto far = std::ranges::count_if(accepted, [&](const Accepted& pair) { return !near(pair); });
  EXPECT_LE(far, 12);
}

TEST(Photographs, TwoVisitsToAPlaceMeet) {
  for (const std::string place : {"magasin", "studio"}) {
    const std::string a = "places-two-visits/" + place + "/A";
    const std::string b = "places-two-visits/" + place + "/B";
    REQUIRE_PHOTOGRAPHS(a);
    REQUIRE_PHOTOGRAPHS(b);
    const auto accepted = accepted_pairs(photographs(a), photographs(b));
    const auto same = std::ranges::count_if(accepted, [](const Accepted& p) { return p.a == p.b; });
    EXPECT_GE(same, 9) << place;
    for (const Accepted& p : accepted) EXPECT_LE(std::abs(p.a - p.b), 2) << place << ' ' << p.a << ' ' << p.b;
  }
}

TEST(Photographs, TwoRunsThroughAnOfficeMeetInOrder) {
  REQUIRE_PHOTOGRAPHS("office-two-runs/reference");
  if (photographs("office-two-runs/live", 4).empty())
    GTEST_SKIP() << "photographs of office-two-runs/live are not here";
  const auto& reference = photographs("office-two-runs/reference");
  const auto& live = photographs("office-two-runs/live", 4);
  auto accepted = accepted_pairs(reference, live);
  EXPECT_GE(accepted.size(), 100u);
  // Both runs follow one route: the further in one, the further in the other (Kendall's rank correlation).
  double agree = 0;
  double pairs = 0;
  for (const Accepted& p : accepted) {
    for (const Accepted& q : accepted) {
      if (p.a < q.a && p.b != q.b) {
        agree += p.b < q.b ? 1 : 0;
        ++pairs;
      }
    }
  }
  EXPECT_GT(agree, 0.85 * pairs);
}

// Frames of an office and a corridor with the same two lines of text in all of them.
TEST(Photographs, ACamerasOwnTextJoinsNothing) {
  const std::string cases = "../cases/static-overlay/";
  REQUIRE_PHOTOGRAPHS(cases + "office");
  REQUIRE_PHOTOGRAPHS(cases + "corridor");
  EXPECT_EQ(accepted_pairs(photographs(cases + "office"), photographs(cases + "corridor")).size(), 0u);
  // Not fewer within each than a verifier that asks for more found with the features under the text taken away: 17, 4.
  const auto within = [](const std::vector<Photograph>& images) {
    const EpipolarVerifier verifier;
    int accepted = 0;
    for (std::size_t i = 0; i < images.size(); ++i) {
      for (std::size_t j = i + 1; j < images.size(); ++j) {
        accepted += verifier.verify(images[i].appearances, images[j].appearances).accepted ? 1 : 0;
      }
    }
    return accepted;
  };
  EXPECT_GE(within(photographs(cases + "office")), 17);
  EXPECT_GE(within(photographs(cases + "corridor")), 4);
}

}  // namespace
}  // namespace mapweld
