// Masks of maps, from the PNG that is sent to the features that are found.
#include "server/services/mask_service.h"

#include <algorithm>
#include <cstdint>
#include <span>
#include <string>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "schema/maps/map_store.h"
#include "schema/maps/vertex_store.h"
#include "schema/store_check.h"
#include "tests/server/support/services_under_test.h"
#include "tests/server/support/test_photos.h"

namespace mapweld::test {
namespace {

std::span<const std::uint8_t> bytes_of(const std::string& text) {
  return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
}

// White but for the lowest quarter, where a robot sees its own body. A tenth of the photographs' size.
cv::Mat body_mask() {
  cv::Mat mask(24, 32, CV_8UC1, cv::Scalar(255));
  mask.rowRange(18, 24) = cv::Scalar(0);
  return mask;
}

float lowest_feature(Store& store, const std::string& map, std::uint32_t vertex) {
  const ReadTransaction db = store.read();
  const MapRow row = find_map(db, map).value();
  float lowest = 0;
  for (const Appearance& a : load_appearances(db, row.id, row.vocabulary, VertexId{vertex}).appearances) {
    lowest = std::max(lowest, a.y_px);
  }
  return lowest;
}

TEST(MaskService, AppliesToWhatComesAfter) {
  ServicesUnderTest services;
  services.create_map("lab");
  services.upload("lab", "before", photo_jpeg(1, 0));
  const std::string png_bytes = png(body_mask());
  services.masks().set("lab", bytes_of(png_bytes));
  services.upload("lab", "after", photo_jpeg(1, 3));
  EXPECT_GT(lowest_feature(services.store(), "lab", 0), 200);
  EXPECT_LT(lowest_feature(services.store(), "lab", 1), 180);
  EXPECT_GT(lowest_feature(services.store(), "lab", 1), 150);

  services.restart();
  EXPECT_EQ(services.masks().get("lab").bytes, png_bytes);
  EXPECT_EQ(services.masks().get("lab").media_type, "image/png");
  services.upload("lab", "later", photo_jpeg(1, 6));
  EXPECT_LT(lowest_feature(services.store(), "lab", 2), 180);
  EXPECT_TRUE(check_store(services.store().read()).findings.empty());

  services.masks().clear("lab");
  services.upload("lab", "unmasked", photo_jpeg(1, 9));
  EXPECT_GT(lowest_feature(services.store(), "lab", 3), 200);
}

TEST(MaskService, QueriesAreMaskedToo) {
  ServicesUnderTest services;
  services.create_map("lab");
  services.upload("lab", "a", photo_jpeg(1, 0));
  const auto features = [&] {
    const std::string image = photo_jpeg(1, 0);
    return services.localization().localize("lab", {.image = bytes_of(image)}).funnel.features;
  };
  const int whole = features();
  const cv::Mat left_half_of_two = (cv::Mat_<std::uint8_t>(1, 2) << 255, 0);
  const std::string left_half = png(left_half_of_two);
  services.masks().set("lab", bytes_of(left_half));
  EXPECT_LT(features(), whole * 3 / 4);
  EXPECT_GT(features(), 20);
}

TEST(MaskService, TheMapTellsAndItsRevisionGrows) {
  ServicesUnderTest services;
  services.create_map("lab");
  EXPECT_EQ(services.maps().get("lab").mask, std::nullopt);
  EXPECT_EQ(code_of([&] { services.masks().get("lab"); }), "no_such_mask");
  services.masks().clear("lab");
  EXPECT_EQ(services.maps().get("lab").revision, 0);
  for (int i = 1; i <= 2; ++i) {  // the second takes the place of the first
    const std::string png_bytes = png(body_mask());
    services.masks().set("lab", bytes_of(png_bytes));
    const contract::Map map = services.maps().get("lab");
    ASSERT_TRUE(map.mask);
    EXPECT_EQ(map.mask->width_px, 32);
    EXPECT_EQ(map.mask->height_px, 24);
    EXPECT_DOUBLE_EQ(map.mask->used_share, 0.75);
    EXPECT_EQ(map.mask->sha256, services.masks().get("lab").sha256);
    EXPECT_EQ(map.revision, i);
  }
  services.masks().clear("lab");
  EXPECT_EQ(services.maps().get("lab").mask, std::nullopt);
  EXPECT_EQ(services.maps().get("lab").revision, 3);
}

TEST(MaskService, GoesWithItsMap) {
  ServicesUnderTest services;
  services.create_map("lab");
  const std::string png_bytes = png(body_mask());
  services.masks().set("lab", bytes_of(png_bytes));
  services.maps().remove("lab");
  services.create_map("lab");
  EXPECT_EQ(services.maps().get("lab").mask, std::nullopt);
}

TEST(MaskService, WhatIsNoMaskChangesNothing) {
  ServicesUnderTest services;
  services.create_map("lab");
  const std::string good = png(body_mask());
  services.masks().set("lab", bytes_of(good));
  const std::string stored = dump_store(services.store());
  const auto code = [&](const std::string& map, const std::string& bytes) {
    return code_of([&] { services.masks().set(map, bytes_of(bytes)); });
  };
  EXPECT_EQ(code("lab", photo_jpeg(1, 0)), "unsupported_image");
  EXPECT_EQ(code("lab", good.substr(0, good.size() / 2)), "undecodable_image");
  EXPECT_EQ(code("lab", png(cv::Mat(9, 9, CV_8UC1, cv::Scalar(0)))), "empty_mask");
  EXPECT_EQ(code("lab", ""), "empty_body");
  EXPECT_EQ(code("x", good), "no_such_map");
  EXPECT_EQ(code_of([&] { services.masks().get("x"); }), "no_such_map");
  EXPECT_EQ(code_of([&] { services.masks().clear("x"); }), "no_such_map");
  EXPECT_EQ(dump_store(services.store()), stored);
}

}  // namespace
}  // namespace mapweld::test
