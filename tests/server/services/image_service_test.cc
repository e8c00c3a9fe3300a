#include "server/services/image_service.h"

#include <chrono>
#include <thread>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "client/contract/problem.h"
#include "schema/maps/edge_store.h"
#include "schema/maps/vertex_store.h"
#include "schema/store_check.h"
#include "server/maps/map_settings.h"
#include "tests/server/support/services_under_test.h"
#include "tests/server/support/test_photos.h"
#include "tests/server/support/uploads.h"

namespace mapweld::test {
namespace {

using server::UploadOutcome;

TEST(ImageService, ADriveBecomesAMap) {
  ServicesUnderTest services;
  services.create_map("lab");
  for (int step = 0; step < 6; ++step) {
    const UploadOutcome outcome = services.upload("lab", "step-" + std::to_string(step), photo_jpeg(1, step));
    EXPECT_TRUE(outcome.created);
    EXPECT_EQ(outcome.upload.outcome, "inserted");
    EXPECT_EQ(outcome.upload.vertex, step);
    EXPECT_GT(outcome.upload.features, 50);
    EXPECT_GT(outcome.upload.took_ms, 0);
    if (step == 0) {
      EXPECT_TRUE(outcome.upload.edges->empty());
      EXPECT_EQ(outcome.upload.reason, "no_candidate");
    } else {
      ASSERT_FALSE(outcome.upload.edges->empty()) << step;
      EXPECT_EQ(outcome.upload.edges->front().vertex, step - 1);
      EXPECT_EQ(outcome.upload.reason, std::nullopt);
    }
  }
  const contract::Map map = services.maps().get("lab");
  EXPECT_EQ(map.vertices, 6);
  EXPECT_EQ(map.revision, 6);
  EXPECT_TRUE(check_store(services.store().read()).findings.empty());
}

TEST(ImageService, AnImageSeenBeforeIsIgnored) {
  ServicesUnderTest services;
  services.create_map("lab");
  services.upload("lab", "a", photo_jpeg(1, 0));
  const UploadOutcome outcome = services.upload("lab", "b", png(photo(1, 0)));
  EXPECT_FALSE(outcome.created);
  EXPECT_EQ(outcome.upload.outcome, "ignored");
  EXPECT_EQ(outcome.upload.reason, "too_similar");
  EXPECT_EQ(outcome.upload.similar_to, 0);
  EXPECT_GT(outcome.upload.inliers, 150);
  EXPECT_EQ(outcome.upload.vertex, std::nullopt);
  EXPECT_EQ(services.maps().get("lab").ignored, 1);
  EXPECT_EQ(services.maps().get("lab").vertices, 1);
  EXPECT_EQ(services.maps().ignored("lab", {}).items.at(0).name, "b");
}

TEST(ImageService, TheSameBytesUnderOtherNamesAreIgnoredAtOnce) {
  ServicesUnderTest services;
  services.create_map("lab");
  const std::string image = photo_jpeg(1, 0);
  const UploadOutcome first = services.upload("lab", "0", image);
  for (int i = 1; i < 10; ++i) {
    const UploadOutcome again = services.upload("lab", std::to_string(i), image);
    EXPECT_FALSE(again.created);
    EXPECT_EQ(again.upload.outcome, "ignored");
    EXPECT_EQ(again.upload.reason, "identical");
    EXPECT_EQ(again.upload.similar_to, 0);
    EXPECT_EQ(again.upload.inliers, first.upload.features);
    EXPECT_EQ(again.upload.features, first.upload.features);
  }
  EXPECT_EQ(services.metrics().stage(server::Stage::kSift).summary().count, 1u) << "they are not looked at";
  EXPECT_EQ(services.upload("lab", "4", image).upload.reason, "identical") << "the first outcome, again";
  EXPECT_EQ(services.maps().get("lab").vertices, 1);
  EXPECT_EQ(services.maps().get("lab").ignored, 9);
  EXPECT_EQ(services.maps().ignored("lab", {}).items.at(8).reason, "identical");

  services.upload("lab", "like", png(photo(1, 0)));  // ignored as too similar
  const UploadOutcome twin = services.upload("lab", "twin of like", png(photo(1, 0)));
  EXPECT_EQ(twin.upload.reason, "identical");
  EXPECT_EQ(twin.upload.similar_to, 0);
  EXPECT_GT(twin.upload.inliers, 150);
  EXPECT_TRUE(check_store(services.store().read()).findings.empty());
}

TEST(ImageService, TransparentPixelsBearNoFeatures) {
  ServicesUnderTest services;
  services.create_map("lab");
  cv::Mat rgba(240, 320, CV_8UC4, cv::Scalar(0, 0, 0, 255));
  const cv::Mat picture = photo(1, 0);
  const int channels[] = {0, 0, 1, 1, 2, 2};
  cv::mixChannels(&picture, 1, &rgba, 1, channels, 3);
  rgba.colRange(160, 320).setTo(cv::Scalar(0, 0, 255, 0));
  const UploadOutcome outcome = services.upload("lab", "a", png(rgba));
  EXPECT_GT(outcome.upload.features, 50);
  const ReadTransaction db = services.store().read();
  const MapRow map = find_map(db, "lab").value();
  for (const Appearance& a : load_appearances(db, map.id, map.vocabulary, VertexId{0}).appearances) {
    EXPECT_LT(a.x_px, 160);
  }
}

TEST(ImageService, ABlankWallIsAVertexWithoutEdges) {
  ServicesUnderTest services;
  services.create_map("lab");
  services.upload("lab", "a", photo_jpeg(1, 0));
  const UploadOutcome outcome = services.upload("lab", "blank", jpeg(blank()));
  EXPECT_TRUE(outcome.created);
  EXPECT_EQ(outcome.upload.features, 0);
  EXPECT_EQ(outcome.upload.reason, "too_few_features");
  EXPECT_TRUE(services.upload("lab", "blank-2", png(blank(1, 1))).created);
}

TEST(ImageService, TheSameUploadGetsItsFirstOutcomeAgain) {
  ServicesUnderTest services;
  services.create_map("lab");
  const auto images = drive_there_and_back(4);
  std::vector<contract::Upload> first;
  for (std::size_t i = 0; i < images.size(); ++i) {
    first.push_back(services.upload("lab", std::to_string(i), images[i]).upload);
  }
  const std::string stored = dump_store(services.store());
  services.restart();
  for (std::size_t i = 0; i < images.size(); ++i) {
    UploadOutcome again = services.upload("lab", std::to_string(i), images[i]);
    EXPECT_FALSE(again.created);
    again.upload.took_ms = first[i].took_ms;
    EXPECT_EQ(again.upload, first[i]);
  }
  EXPECT_EQ(code_of([&] { services.upload("lab", "0", images[1]); }), "name_taken");
  EXPECT_EQ(code_of([&] { services.upload("lab", "5", images[1]); }), "name_taken");  // an ignored one
  EXPECT_EQ(dump_store(services.store()), stored);
}

TEST(ImageService, UnnamedImagesFindAFreeName) {
  ServicesUnderTest services;
  services.create_map("lab");
  EXPECT_EQ(services.upload("lab", "1", photo_jpeg(1, 0)).upload.name, "1");
  EXPECT_EQ(services.upload("lab", "", photo_jpeg(1, 1)).upload.name, "1-2");
  EXPECT_EQ(services.upload("lab", "", photo_jpeg(1, 2)).upload.name, "2");
  EXPECT_EQ(services.upload("lab", "", png(photo(1, 2))).upload.name, "ignored-0");
}

TEST(ImageService, WhatIsNotAMapOfOnesOwnIsRefused) {
  ServicesUnderTest services;
  services.create_map("lab");
  const std::string stored = dump_store(services.store());
  const std::string image = photo_jpeg(1, 0);
  EXPECT_EQ(code_of([&] { services.upload("other", "a", image); }), "no_such_map");
  EXPECT_EQ(
      code_of([&] { services.images().upload("lab", upload_of("a", image), "00000000-0000-4000-8000-000000000000"); }),
      "wrong_map");
  EXPECT_EQ(dump_store(services.store()), stored);
  EXPECT_TRUE(services.images().upload("lab", upload_of("a", image), services.maps().get("lab").uuid).created);
}

TEST(ImageService, BytesAreKeptOnlyWhenTheMapSaysSo) {
  ServicesUnderTest services;
  contract::CreateMap request;
  request.name = "light";
  request.parameters.emplace();
  request.parameters->store_images = "none";
  services.maps().create(request);
  services.create_map("full");
  const std::string image = photo_jpeg(1, 0);
  services.upload("light", "a", image);
  services.upload("full", "a", image);
  EXPECT_EQ(services.maps().image("full", 0).bytes, image);
  EXPECT_EQ(services.maps().image("full", 0).media_type, "image/jpeg");
  EXPECT_EQ(code_of([&] { services.maps().image("light", 0); }), "no_such_image");
}

TEST(ImageService, AServerThatStopsRefusesWhatIsNotYetStored) {
  ServicesUnderTest services;
  services.create_map("lab");
  services.images().refuse_after(std::chrono::steady_clock::now());
  EXPECT_EQ(code_of([&] { services.upload("lab", "a", photo_jpeg(1, 0)); }), "shutting_down");
}

// As after a commit that failed, and was made all the same.
TEST(ImageService, AMapInMemoryThatIsNotTheStoredOneIsReadAnew) {
  ServicesUnderTest services;
  services.create_map("lab");
  services.upload("lab", "a", photo_jpeg(1, 0));
  const MapRow map = find_map(services.store().read(), "lab").value();
  const auto loaded = services.cache().open(map, 500);
  loaded->append(std::make_shared<const AppearanceVector>(), {});
  loaded->commit();
  EXPECT_THROW(services.upload("lab", "b", photo_jpeg(2, 0)), StoreError);
  EXPECT_EQ(services.maps().get("lab").vertices, 1);
  EXPECT_EQ(services.upload("lab", "b", photo_jpeg(2, 0)).upload.vertex, 1);
  EXPECT_TRUE(check_store(services.store().read()).findings.empty());
}

TEST(ImageService, UploadsFromManySidesAllArrive) {
  ServicesUnderTest services;
  services.create_map("left");
  services.create_map("right");
  std::vector<std::thread> robots;
  for (int robot = 0; robot < 4; ++robot) {
    robots.emplace_back([&, robot] {
      for (int step = 0; step < 6; ++step) {
        const std::string name = "robot-" + std::to_string(robot) + "-" + std::to_string(step);
        services.upload(robot % 2 == 0 ? "left" : "right", name, photo_jpeg(static_cast<std::uint64_t>(robot), step));
      }
    });
  }
  for (std::thread& robot : robots) robot.join();
  for (const char* name : {"left", "right"}) {
    const contract::Map map = services.maps().get(name);
    EXPECT_EQ(map.vertices + map.ignored, 12);
  }
  EXPECT_TRUE(check_store(services.store().read()).findings.empty());
}

}  // namespace
}  // namespace mapweld::test
