// What a map learns of a camera that writes over its pictures, from upload to answer.
#include <string>
#include <tuple>
#include <vector>

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include "schema/maps/edge_store.h"
#include "schema/maps/vertex_store.h"
#include "schema/store_check.h"
#include "tests/server/support/services_under_test.h"
#include "tests/server/support/test_photos.h"
#include "tests/server/support/uploads.h"

namespace mapweld::test {
namespace {

using server::ImageUpload;
using server::UploadOutcome;

std::string with_text(cv::Mat image) {
  const cv::Scalar white(255, 255, 255);
  cv::rectangle(image, {0, 196}, {319, 239}, {0, 0, 0}, cv::FILLED);
  cv::putText(image, "CAM 7  North Wing  f/2.8", {4, 213}, cv::FONT_HERSHEY_SIMPLEX, 0.55, white, 1, cv::LINE_AA);
  cv::putText(image, "ISO 400  Exposure 1/60 s", {4, 233}, cv::FONT_HERSHEY_SIMPLEX, 0.55, white, 1, cv::LINE_AA);
  return png(image);
}

// Walls that share nothing, some of them seen from two neighbouring places.
std::vector<std::string> drive() {
  std::vector<std::string> images;
  for (std::uint64_t wall = 1; wall <= 10; ++wall) {
    images.push_back(with_text(photo(wall, 3)));
    if (wall % 2 == 0) images.push_back(with_text(photo(wall, 4)));
  }
  return images;
}

struct Content {
  std::vector<std::tuple<std::string, int, int>> images;  // name, features, static ones
  std::vector<AppearanceVector> appearances;
  std::vector<Edge> edges;
  friend bool operator==(const Content&, const Content&) = default;
};

Content content(Store& store, const std::string& name) {
  const ReadTransaction db = store.read();
  const MapRow map = find_map(db, name).value();
  const MapLayout layout = load_layout(db, map.id);
  Content content;
  for (const VertexRow& row : list_vertices(db, layout, 1000)) {
    content.images.emplace_back(row.image.name, row.image.features, row.image.static_features);
  }
  content.appearances = load_appearances(db, map.id, map.vocabulary, VertexId{0}, map.vertices);
  content.edges = load_edges(db, layout);
  return content;
}

TEST(StaticImages, AreTheSameMapHoweverTheyAreUploaded) {
  const auto images = drive();
  const auto uploads = name_all(images);
  Content expected;
  {
    ServicesUnderTest services;
    services.create_map("lab");
    for (const ImageUpload& upload : uploads) services.images().upload("lab", upload, std::nullopt);
    expected = content(services.store(), "lab");
    EXPECT_TRUE(check_store(services.store().read()).findings.empty());
  }
  ASSERT_EQ(expected.images.size(), images.size());
  for (std::size_t v = 0; v < images.size(); ++v) {
    const auto& [name, features, fixed] = expected.images[v];
    if (v < 4) {
      EXPECT_EQ(fixed, 0) << name;
    }
    if (v > 6) {
      EXPECT_GE(fixed, 20) << name;
    }
    const AppearanceVector& vector = expected.appearances[v];
    EXPECT_EQ(vector.static_appearances.size(), static_cast<std::size_t>(fixed));
    EXPECT_EQ(vector.appearances.size() + vector.static_appearances.size(), static_cast<std::size_t>(features));
    for (const Appearance& a : vector.static_appearances) EXPECT_GE(a.y_px, 190);
  }
  EXPECT_EQ(expected.edges.size(), 5u);
  for (const ServicesOptions& options : upload_variants()) {
    ServicesUnderTest services(options);
    services.create_map("lab");
    services.images().upload_batch("lab", {uploads.begin(), uploads.begin() + 6}, std::nullopt);
    services.restart();
    services.images().upload_batch("lab", {uploads.begin() + 6, uploads.begin() + 9}, std::nullopt);
    services.restart();
    services.images().upload_batch("lab", {uploads.begin() + 9, uploads.end()}, std::nullopt);
    EXPECT_EQ(content(services.store(), "lab"), expected)
        << options.workers << " workers, cache of " << options.cache_bytes;
  }
}

TEST(StaticImages, WhatIsThoughtOfEdgesTeachesNothing) {
  const auto images = drive();
  const auto uploads = name_all(images);
  ServicesUnderTest plain, judged;
  for (ServicesUnderTest* services : {&plain, &judged}) {
    services->create_map("lab");
    services->images().upload_batch("lab", {uploads.begin(), uploads.begin() + 6}, std::nullopt);
  }
  const MapRow map = find_map(judged.store().read(), "lab").value();
  std::vector<JudgedEdge> withheld;
  for (const Edge& edge : load_edges(judged.store().read(), load_layout(judged.store().read(), map.id))) {
    withheld.push_back({edge.u, edge.v, {0.1, Reason::kUnsupported, {}}});
  }
  ASSERT_FALSE(withheld.empty());
  {
    const auto turn = judged.cache().writer_turn(map.id);
    WriteTransaction db = judged.store().write();
    set_judgements(db, map.id, withheld);
    db.commit();
    judged.cache().follow_judgements(map.id, withheld);
  }
  for (ServicesUnderTest* services : {&plain, &judged}) {
    services->images().upload_batch("lab", {uploads.begin() + 6, uploads.end()}, std::nullopt);
  }
  EXPECT_EQ(content(judged.store(), "lab"), content(plain.store(), "lab"));
}

TEST(StaticImages, AMapShowsHowMuchOfTheFrameItIs) {
  ServicesUnderTest services;
  services.create_map("lab");
  services.create_map("bare");
  const auto images = drive();
  for (std::size_t i = 0; i < images.size(); ++i) services.upload("lab", std::to_string(i), images[i]);
  for (int step = 0; step < 12; ++step) services.upload("bare", std::to_string(step), photo_jpeg(20, step));
  const double share = services.maps().get("lab").static_share;
  EXPECT_GT(share, 0.05);
  EXPECT_LE(share, 0.25);
  EXPECT_EQ(services.maps().get("bare").static_share, 0);
  contract::SubmitMerge request;
  request.maps = {"lab", "bare"};
  request.name = "both";
  services.merges().submit(request);
  const auto vertices = [&](const std::string& map) { return static_cast<double>(services.maps().get(map).vertices); };
  EXPECT_NEAR(services.maps().get("both").static_share, share * vertices("lab") / vertices("both"), 1e-12);
}

TEST(StaticImages, AQueryIsFoundByTheRestOfIt) {
  ServicesUnderTest services;
  services.create_map("lab");
  const auto images = drive();
  for (std::size_t i = 0; i < images.size(); ++i) services.upload("lab", std::to_string(i), images[i]);
  const auto localize = [&](const std::string& image) {
    server::LocalizeQuery query;
    query.image = {reinterpret_cast<const std::uint8_t*>(image.data()), image.size()};
    return services.localization().localize("lab", query);
  };
  EXPECT_EQ(localize(with_text(photo(50, 3))).status, "not_found");
  for (const std::string& query : {with_text(photo(9, 3)), png(photo(9, 3)), with_text(photo(1, 3))}) {
    const contract::Localization found = localize(query);
    EXPECT_EQ(found.status, "localized");
    EXPECT_EQ(found.matches.at(0).name, query == with_text(photo(1, 3)) ? "0" : "12");
  }
}

}  // namespace
}  // namespace mapweld::test
