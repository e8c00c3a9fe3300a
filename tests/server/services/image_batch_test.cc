// Many images in one request: the map is the one that they make one by one.
#include <algorithm>
#include <chrono>
#include <string>
#include <thread>
#include <variant>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "schema/maps/edge_store.h"
#include "schema/maps/vertex_store.h"
#include "server/services/image_service.h"
#include "tests/server/support/services_under_test.h"
#include "tests/server/support/test_photos.h"
#include "tests/server/support/uploads.h"

namespace mapweld::test {
namespace {

using server::BatchOutcome;
using server::ImageUpload;
using server::UploadOutcome;

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

TEST(ImageBatch, TheSameBytesAreIgnoredWithinItToo) {
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

TEST(ImageBatch, MakesTheMapThatSingleUploadsMake) {
  const auto images = drive_there_and_back(8);
  std::string expected;
  {
    ServicesUnderTest services;
    services.create_map("lab");
    for (std::size_t i = 0; i < images.size(); ++i) services.upload("lab", "image-" + std::to_string(i), images[i]);
    expected = content(services.store(), "lab");
  }
  EXPECT_THAT(expected, ::testing::HasSubstr("like"));
  for (const ServicesOptions& options : upload_variants()) {
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
    if (options.cache_bytes > 0) {
      EXPECT_LE(commits, 2 + uploads.size() / static_cast<std::size_t>(options.images.max_group));  // groups share them
    } else {
      EXPECT_EQ(commits, uploads.size());
    }
    EXPECT_EQ(content(services.store(), "lab"), expected)
        << options.workers << " workers, cache of " << options.cache_bytes;
  }
}

TEST(ImageBatch, GoesOnAfterARestart) {
  const auto images = drive_there_and_back(8);
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

TEST(ImageBatch, EachImageHasItsOwnOutcome) {
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

TEST(ImageBatch, AFullDiskLeavesTheMapAsItWas) {
  ServicesUnderTest services;
  services.create_map("lab");
  services.upload("lab", "a", photo_jpeg(1, 9));
  const std::string stored = dump_store(services.store());
  const ReadTransaction db = services.store().read();
  services.store().limit_pages(1);  // no page more than there are
  const auto images = drive_there_and_back(6);
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

}  // namespace
}  // namespace mapweld::test
