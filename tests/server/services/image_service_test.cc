#include "server/services/image_service.h"

#include <algorithm>
#include <chrono>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "client/contract/problem.h"
#include "schema/edge_store.h"
#include "schema/store_check.h"
#include "schema/vertex_store.h"
#include "server/maps/map_settings.h"
#include "tests/server/support/services_under_test.h"
#include "tests/server/support/test_photos.h"

namespace mapweld::test {
namespace {

using server::BatchOutcome;
using server::ImageUpload;
using server::UploadOutcome;

ImageUpload upload_of(const std::string& name, const std::string& bytes) {
  ImageUpload upload;
  upload.name = name;
  upload.bytes = {reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()};
  return upload;
}

// A drive along a wall, there and half of it back: vertices, edges and ignored images.
std::vector<std::string> drive(int steps) {
  std::vector<std::string> images;
  for (int step = 0; step < steps; ++step) images.push_back(photo_jpeg(1, step));
  for (int step = steps - 1; step >= steps / 2; --step) images.push_back(photo_jpeg(1, step) + std::string(1, '\0'));
  return images;
}

std::vector<ImageUpload> name_all(const std::vector<std::string>& images) {
  std::vector<ImageUpload> uploads;
  for (std::size_t i = 0; i < images.size(); ++i) uploads.push_back(upload_of("image-" + std::to_string(i), images[i]));
  return uploads;
}

// Uploads a batch into a map whose turn is taken until every image is analysed: then as many as may share a transaction
// do.
std::vector<BatchOutcome> upload_held(ServicesUnderTest& services, const std::string& map,
                                      const std::vector<ImageUpload>& uploads) {
  const MapId id = find_map(services.store().read(), map).value().id;
  auto turn = services.cache().writer_turn(id);
  std::vector<BatchOutcome> outcomes;
  std::thread upload([&] { outcomes = services.images().upload_batch(map, uploads, std::nullopt); });
  while (services.metrics().stage(server::Stage::kQuantise).summary().count < uploads.size()) {
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  turn.unlock();
  upload.join();
  return outcomes;
}

// Everything of a map but the times.
std::string content(Store& store, const std::string& name) {
  const ReadTransaction db = store.read();
  const MapRow map = find_map(db, name).value();
  std::string out;
  const MapLayout layout = load_layout(db, map.id);
  for (const VertexRow& row : list_vertices(db, layout, 1000)) {
    out +=
        std::to_string(to_index(row.vertex)) + " " + row.image.name + " " + std::to_string(row.image.features) + "\n";
    for (const Appearance& a : load_appearances(db, map.id, map.vocabulary, row.vertex).appearances) {
      out += std::to_string(to_index(a.word)) + ":" + std::to_string(a.x_px) + "," + std::to_string(a.y_px) + " ";
    }
  }
  for (const EdgeRow& edge : list_edges(db, layout, {}, 1000).edges) {
    out += std::to_string(to_index(edge.u)) + "-" + std::to_string(to_index(edge.v)) + " " +
           std::to_string(edge.votes) + " " + std::to_string(edge.inliers) + "\n";
  }
  for (const ImageRow& image : list_ignored(db, map.id, 1000)) {
    out += image.name + " like " + std::to_string(to_index(*image.similar_to)) + "\n";
  }
  return out;
}

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

TEST(ImageService, InABatchToo) {
  const std::string wall = jpeg(blank());
  const std::string image = photo_jpeg(1, 0);
  const std::vector<ImageUpload> uploads = {upload_of("a", image), upload_of("b", image), upload_of("c", wall),
                                            upload_of("d", image), upload_of("", image),  upload_of("e", wall),
                                            upload_of("b", image), upload_of("f", wall)};
  std::string content_of_singles;
  {
    ServicesUnderTest singles;
    singles.create_map("lab");
    for (const ImageUpload& upload : uploads) singles.images().upload("lab", upload, std::nullopt);
    content_of_singles = content(singles.store(), "lab");
  }
  ServicesUnderTest services;
  services.create_map("lab");
  const auto outcomes = upload_held(services, "lab", uploads);
  std::vector<std::string> reasons;
  for (const BatchOutcome& outcome : outcomes) {
    reasons.push_back(std::get<UploadOutcome>(outcome).upload.reason.value_or("none"));
  }
  EXPECT_THAT(reasons, testing::ElementsAre("no_candidate", "identical", "too_few_features", "identical", "identical",
                                            "identical", "identical", "identical"));
  EXPECT_EQ(content(services.store(), "lab"), content_of_singles);
  EXPECT_EQ(std::get<UploadOutcome>(outcomes[7]).upload.similar_to, 1);
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
  const auto images = drive(4);
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

TEST(ImageService, ABatchMakesTheMapThatSingleUploadsMake) {
  const auto images = drive(8);
  std::string expected;
  {
    ServicesUnderTest services;
    services.create_map("lab");
    for (std::size_t i = 0; i < images.size(); ++i) services.upload("lab", "image-" + std::to_string(i), images[i]);
    expected = content(services.store(), "lab");
  }
  EXPECT_THAT(expected, ::testing::HasSubstr("like"));
  struct Variant {
    int workers;
    int max_group;
    std::size_t cache_bytes;
  };
  for (const auto& [workers, max_group, cache_bytes] :
       {Variant{1, 16, 256 << 20}, Variant{4, 16, 256 << 20}, Variant{8, 3, 256 << 20}, Variant{2, 16, 0}}) {
    ServicesOptions options;
    options.workers = workers;
    options.images.max_group = max_group;
    options.cache_bytes = cache_bytes;  // 0: straight from the store
    ServicesUnderTest services(options);
    services.create_map("lab");
    std::vector<ImageUpload> uploads = name_all(images);
    services.images().upload("lab", uploads.front(), std::nullopt);
    uploads.erase(uploads.begin());
    services.restart();  // the map leaves memory, and comes back only where it fits
    const std::uint64_t before = services.store().statistics().commits;
    for (const BatchOutcome& outcome : upload_held(services, "lab", uploads)) {
      EXPECT_TRUE(std::holds_alternative<UploadOutcome>(outcome));
    }
    const std::uint64_t commits = services.store().statistics().commits - before;
    if (cache_bytes > 0) {
      EXPECT_LE(commits, 2 + uploads.size() / static_cast<std::size_t>(max_group));  // groups share them
    } else {
      EXPECT_EQ(commits, uploads.size());
    }
    EXPECT_EQ(content(services.store(), "lab"), expected) << workers << " workers, cache of " << cache_bytes;
  }
}

TEST(ImageService, ABatchGoesOnAfterARestart) {
  const auto images = drive(8);
  const auto uploads = name_all(images);
  ServicesUnderTest whole;
  whole.create_map("lab");
  whole.images().upload_batch("lab", uploads, std::nullopt);
  ServicesUnderTest parts;
  parts.create_map("lab");
  parts.images().upload_batch("lab", {uploads.begin(), uploads.begin() + 5}, std::nullopt);
  parts.restart();
  parts.images().upload_batch("lab", uploads, std::nullopt);
  EXPECT_EQ(content(parts.store(), "lab"), content(whole.store(), "lab"));
}

TEST(ImageService, EachImageOfABatchHasItsOwnOutcome) {
  ServicesUnderTest services;
  services.create_map("lab");
  const std::string good_0 = photo_jpeg(1, 0);
  const std::string good_1 = photo_jpeg(1, 1);
  const std::string truncated = good_0.substr(0, good_0.size() / 2);
  const std::string text = "not an image";
  std::vector<ImageUpload> uploads = {
      upload_of("a", good_0),     upload_of("b", truncated), upload_of("c", text),
      upload_of("d", ""),         upload_of("a", good_0),    upload_of("a", good_1),
      upload_of("bad\n", good_1), upload_of("e", good_1),    upload_of("", photo_jpeg(1, 2))};
  const std::string last = photo_jpeg(1, 2);
  uploads.back() = upload_of("", last);
  const std::vector<BatchOutcome> outcomes = services.images().upload_batch("lab", uploads, std::nullopt);
  const auto code = [&](std::size_t i) {
    return code_of([&] {
      if (const auto* error = std::get_if<std::exception_ptr>(&outcomes[i])) std::rethrow_exception(*error);
    });
  };
  EXPECT_EQ(code(0), "none");
  EXPECT_EQ(code(1), "undecodable_image");
  EXPECT_EQ(code(2), "unsupported_image");
  EXPECT_EQ(code(3), "empty_body");
  EXPECT_EQ(code(4), "none");
  EXPECT_FALSE(std::get<UploadOutcome>(outcomes[4]).created);
  EXPECT_EQ(std::get<UploadOutcome>(outcomes[4]).upload.vertex, 0);
  EXPECT_EQ(code(5), "name_taken");
  EXPECT_EQ(code(6), "invalid_name");
  EXPECT_EQ(std::get<UploadOutcome>(outcomes[7]).upload.vertex, 1);
  EXPECT_EQ(std::get<UploadOutcome>(outcomes[8]).upload.name, "2");
  EXPECT_EQ(services.maps().get("lab").vertices, 3);
}

TEST(ImageService, UnnamedImagesFindAFreeName) {
  ServicesUnderTest services;
  services.create_map("lab");
  EXPECT_EQ(services.upload("lab", "1", photo_jpeg(1, 0)).upload.name, "1");
  EXPECT_EQ(services.upload("lab", "", photo_jpeg(1, 1)).upload.name, "1-2");
  EXPECT_EQ(services.upload("lab", "", photo_jpeg(1, 2)).upload.name, "2");
  EXPECT_EQ(services.upload("lab", "", png(photo(1, 2))).upload.name, "ignored-0");
}

TEST(ImageService, AFullDiskLeavesTheMapAsItWas) {
  ServicesUnderTest services;
  services.create_map("lab");
  services.upload("lab", "a", photo_jpeg(1, 9));
  const std::string stored = dump_store(services.store());
  const ReadTransaction db = services.store().read();
  services.store().limit_pages(1);  // no page more than there are
  const auto images = drive(6);
  const auto outcomes = services.images().upload_batch("lab", name_all(images), std::nullopt);
  for (const BatchOutcome& outcome : outcomes) {
    ASSERT_TRUE(std::holds_alternative<std::exception_ptr>(outcome));
    try {
      std::rethrow_exception(std::get<std::exception_ptr>(outcome));
    } catch (const StoreError& error) {
      EXPECT_EQ(error.kind(), StoreErrorKind::kNoSpace);
    }
  }
  EXPECT_EQ(dump_store(services.store()), stored);
  // Memory was rolled back with it: with space again, other images are taken as if nothing had happened.
  services.store().limit_pages(1 << 20);
  auto others = name_all(images);
  std::ranges::reverse(others);
  for (const BatchOutcome& outcome : services.images().upload_batch("lab", others, std::nullopt)) {
    EXPECT_TRUE(std::holds_alternative<UploadOutcome>(outcome));
  }
  ServicesUnderTest fresh;
  fresh.create_map("lab");
  fresh.upload("lab", "a", photo_jpeg(1, 9));
  fresh.images().upload_batch("lab", others, std::nullopt);
  EXPECT_EQ(content(services.store(), "lab"), content(fresh.store(), "lab"));
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
