#include "server/services/localize_service.h"

#include <gtest/gtest.h>

#include "client/contract/problem.h"
#include "tests/server/support/services_under_test.h"
#include "tests/server/support/test_photos.h"

namespace mapweld::test {
namespace {

class Localize : public ::testing::Test {
 protected:
  Localize() {
    services_.create_map("lab");
    for (int step = 0; step < 8; ++step) services_.upload("lab", "step-" + std::to_string(step), photo_jpeg(1, step));
  }

  contract::Localization localize(const std::string& image, std::size_t limit = 5, bool verified_only = false) {
    server::LocalizeQuery query;
    query.image = {reinterpret_cast<const std::uint8_t*>(image.data()), image.size()};
    query.limit = limit;
    query.verified_only = verified_only;
    return services_.localization().localize("lab", query);
  }

  ServicesUnderTest services_;
};

TEST_F(Localize, FindsThePlaceAndChangesNothing) {
  const std::string stored = dump_store(services_.store());
  const contract::Localization found = localize(png(photo(1, 3)));
  EXPECT_EQ(found.status, "localized");
  EXPECT_EQ(found.reason, std::nullopt);
  ASSERT_FALSE(found.matches.empty());
  EXPECT_EQ(found.matches[0].vertex, 3);
  EXPECT_EQ(found.matches[0].map, "lab");
  EXPECT_EQ(found.matches[0].name, "step-3");
  EXPECT_TRUE(found.matches[0].verified);
  EXPECT_EQ(found.funnel.best_inliers, found.matches[0].inliers);
  EXPECT_GT(found.funnel.known_words, 0);
  EXPECT_LE(found.funnel.verified, found.funnel.candidates);
  EXPECT_EQ(dump_store(services_.store()), stored);
}

TEST_F(Localize, SaysWhyNot) {
  const contract::Localization elsewhere = localize(photo_jpeg(2, 0));
  EXPECT_EQ(elsewhere.status, "not_found");
  EXPECT_TRUE(elsewhere.reason.has_value());
  EXPECT_GT(elsewhere.funnel.features, 0);
  const contract::Localization nothing = localize(jpeg(blank()));
  EXPECT_EQ(nothing.status, "not_found");
  EXPECT_EQ(nothing.reason, "too_few_features");
  EXPECT_TRUE(nothing.matches.empty());
}

TEST_F(Localize, ShowsAsManyMatchesAsAskedFor) {
  const std::string image = png(photo(1, 3));
  EXPECT_EQ(localize(image, 1).matches.size(), 1u);
  const contract::Localization all = localize(image, 1000);
  EXPECT_GE(all.matches.size(), 3u);
  for (std::size_t i = 1; i < all.matches.size(); ++i) {
    const contract::Match& before = all.matches[i - 1];
    const contract::Match& match = all.matches[i];
    EXPECT_TRUE(before.verified || !match.verified);
    if (before.verified && match.verified) {
      EXPECT_GE(before.inliers, match.inliers);
    } else if (!before.verified) {
      EXPECT_GE(before.votes, match.votes);
    }
  }
  for (const contract::Match& match : localize(image, 1000, true).matches) EXPECT_TRUE(match.verified);
}

TEST_F(Localize, AnEmptyMapHasNoCandidate) {
  services_.create_map("empty");
  const std::string image = photo_jpeg(1, 0);
  const contract::Localization found = services_.localization().localize(
      "empty", {{reinterpret_cast<const std::uint8_t*>(image.data()), image.size()}, 5, false});
  EXPECT_EQ(found.status, "not_found");
  EXPECT_EQ(found.reason, "no_candidate");
}

TEST_F(Localize, BrokenRequestsAreRefused) {
  EXPECT_EQ(code_of([&] { localize(""); }), "empty_body");
  EXPECT_EQ(code_of([&] { localize("GIF89a..."); }), "unsupported_image");
  EXPECT_EQ(code_of([&] { localize(photo_jpeg(1, 0).substr(0, 900)); }), "undecodable_image");
  EXPECT_EQ(code_of([&] { services_.localization().localize("nope", {}); }), "empty_body");
  const std::string image = photo_jpeg(1, 0);
  EXPECT_EQ(code_of([&] {
              services_.localization().localize(
                  "nope", {{reinterpret_cast<const std::uint8_t*>(image.data()), image.size()}, 5, false});
            }),
            "no_such_map");
}

TEST_F(Localize, AnswersTheSameAfterARestart) {
  const std::string image = png(photo(1, 5));
  const contract::Localization before = localize(image, 1000);
  services_.restart();
  contract::Localization after = localize(image, 1000);
  after.took_ms = before.took_ms;
  EXPECT_EQ(after, before);
}

}  // namespace
}  // namespace mapweld::test
