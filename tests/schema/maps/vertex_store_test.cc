#include "schema/maps/vertex_store.h"

#include <stdexcept>

#include <gtest/gtest.h>

#include "schema/merges/merge_store.h"
#include "tests/support/temp_store.h"

namespace mapweld {
namespace {

using test::Random;
using test::TempStore;

class VertexStoreTest : public testing::Test {
 protected:
  TempStore store_;
  VocabularyId vocabulary_ = test::add_vocabulary(store_);
  MapId map_ = test::add_map(store_, "a", vocabulary_);
  Random random_{21};
};

TEST_F(VertexStoreTest, AnImageComesBackWithEverythingThatWasTold) {
  const AppearanceVector appearances = test::random_appearances(random_, 300, 1'000);
  const auto bytes = test::random_bytes(random_, 20'000);
  NewImage image = test::new_image("kitchen/0001 \xC3\xA9.jpg", appearances);
  image.sha256.fill(7);
  image.media_type = "image/png";
  image.provenance = {test::at(100) + std::chrono::microseconds(123'456), "run-1", 812, R"({"model":"pinhole"})",
                      R"({"frame":"lab"})"};
  image.reason = Reason::kTooFewInliers;
  image.bytes = bytes;
  {
    WriteTransaction db = store_.write();
    EXPECT_EQ(insert_vertex(db, map_, vocabulary_, image, appearances, {}, test::test_verifier(db)), VertexId{0});
    db.commit();
  }
  store_.reopen();
  const ReadTransaction reader = store_.read();
  for (const auto& row : {find_vertex(reader, map_, VertexId{0}), find_image(reader, map_, image.name)}) {
    ASSERT_TRUE(row);
    EXPECT_EQ(row->map, map_);
    EXPECT_EQ(row->vertex, VertexId{0});
    EXPECT_EQ(row->name, image.name);
    EXPECT_EQ(row->sha256, image.sha256);
    EXPECT_EQ(row->media_type, "image/png");
    EXPECT_EQ(row->width_px, 320);
    EXPECT_EQ(row->height_px, 240);
    EXPECT_EQ(row->features, 300);
    EXPECT_EQ(row->provenance, image.provenance);
    EXPECT_EQ(row->reason, Reason::kTooFewInliers);
    EXPECT_EQ(row->similar_to, std::nullopt);
    EXPECT_EQ(row->uploaded_at, image.uploaded_at);
    EXPECT_EQ(row->deleted_at, std::nullopt);
    EXPECT_EQ(load_image_bytes(reader, row->id), bytes);
  }
  EXPECT_EQ(load_appearances(reader, map_, vocabulary_, VertexId{0}), appearances);
  EXPECT_THROW(load_appearances(reader, map_, vocabulary_, VertexId{1}), std::out_of_range);
  EXPECT_FALSE(find_vertex(reader, map_, VertexId{1}));
  EXPECT_EQ(find_map(reader, map_)->revision, 1U);
}

TEST_F(VertexStoreTest, WhatIsStaticComesBackAndTheNewestAreFound) {
  std::vector<AppearanceVector> images;
  for (std::uint32_t v = 0; v < 20; ++v) {
    AppearanceVector image = test::random_appearances(random_, v == 0 ? 0 : 30, 1'000, true);
    if (v % 3 == 0) image.static_appearances = test::random_appearances(random_, 7, 1'000, true).appearances;
    images.push_back(image);
    NewImage row = test::new_image(std::to_string(v), image);
    row.features = static_cast<int>(image.appearances.size() + image.static_appearances.size());
    WriteTransaction db = store_.write();
    insert_vertex(db, map_, vocabulary_, row, image, {}, test::test_verifier(db));
    db.commit();
  }
  store_.reopen();
  const ReadTransaction reader = store_.read();
  EXPECT_EQ(load_appearances(reader, map_, vocabulary_, VertexId{0}, 20), images);
  EXPECT_EQ(find_vertex(reader, map_, VertexId{3})->static_features, 7);
  EXPECT_EQ(find_vertex(reader, map_, VertexId{3})->features, 37);
  EXPECT_EQ(find_vertex(reader, map_, VertexId{4})->static_features, 0);
  const auto newest = [&](std::uint32_t vertices, std::uint32_t count) {
    return load_newest_with_static(reader, map_, vocabulary_, vertices, count);
  };
  EXPECT_EQ(newest(20, 5), (std::vector{images[15], images[18]}));
  EXPECT_EQ(newest(18, 5), (std::vector{images[15]}));
  EXPECT_EQ(newest(20, 100).size(), 7u);
  EXPECT_TRUE(newest(0, 5).empty());
  EXPECT_TRUE(has_signatures(reader, load_layout(reader, map_), vocabulary_)) << "the first image has only static ones";
}

TEST_F(VertexStoreTest, EveryReasonComesBack) {
  for (int r = 0; r <= static_cast<int>(Reason::kUnsupported); ++r) {
    WriteTransaction db = store_.write();
    NewImage image = test::new_image(std::to_string(r), {});
    image.reason = static_cast<Reason>(r);
    const VertexId vertex = insert_vertex(db, map_, vocabulary_, image, {320, 240, {}}, {}, test::test_verifier(db));
    EXPECT_EQ(find_vertex(db, map_, vertex)->reason, image.reason);
    db.commit();
  }
}

TEST_F(VertexStoreTest, IgnoredImagesKeepTheirNameAndWhy) {
  const AppearanceVector appearances = test::random_appearances(random_, 10, 1'000);
  test::add_vertex(store_, map_, vocabulary_, "0", appearances);
  for (int i = 1; i <= 5; ++i) {
    WriteTransaction db = store_.write();
    NewImage image = test::new_image(std::to_string(i), appearances);
    image.provenance.sequence = "run-2";
    insert_ignored(db, map_, image, VertexId{0}, 200 + i);
    db.commit();
  }
  const ReadTransaction reader = store_.read();
  const auto first = list_ignored(reader, map_, 2);
  ASSERT_EQ(first.size(), 2U);
  EXPECT_EQ(first[1].name, "2");
  EXPECT_EQ(first[1].similar_to, VertexId{0});
  EXPECT_EQ(first[1].inliers, 202);
  EXPECT_EQ(first[1].vertex, std::nullopt);
  EXPECT_EQ(first[1].provenance.sequence, "run-2");
  EXPECT_EQ(load_image_bytes(reader, first[1].id), std::nullopt);
  const auto rest = list_ignored(reader, map_, 10, first[1].id);
  ASSERT_EQ(rest.size(), 3U);
  EXPECT_EQ(rest[0].name, "3");
  const auto map = find_map(reader, map_);
  EXPECT_EQ(map->vertices, 1U);
  EXPECT_EQ(map->ignored, 5U);
  EXPECT_EQ(map->revision, 6U);
}

TEST_F(VertexStoreTest, AnImageIsFoundByItsBytes) {
  const AppearanceVector appearances = test::random_appearances(random_, 10, 1'000);
  const MapId other = test::add_map(store_, "b", vocabulary_);
  const auto with = [&](const std::string& name, std::uint8_t content) {
    NewImage image = test::new_image(name, appearances);
    image.sha256.fill(content);
    return image;
  };
  WriteTransaction db = store_.write();
  insert_vertex(db, map_, vocabulary_, with("0", 1), appearances, {}, test::test_verifier(db));
  insert_ignored(db, map_, with("1", 2), VertexId{0}, 201);
  insert_ignored(db, map_, with("2", 2), VertexId{0}, 201, IgnoredReason::kIdentical);
  insert_ignored(db, map_, with("3", 3), VertexId{0}, 10, IgnoredReason::kIdentical);
  insert_vertex(db, map_, vocabulary_, with("4", 3), appearances, {}, test::test_verifier(db));
  const auto name_of = [&](MapId map, std::uint8_t content) {
    Sha256 sha256;
    sha256.fill(content);
    const auto found = find_image(db, map, sha256);
    return found ? found->name : "none";
  };
  EXPECT_EQ(name_of(map_, 1), "0");
  EXPECT_EQ(name_of(map_, 2), "1") << "the first of them";
  EXPECT_EQ(name_of(map_, 3), "4") << "a vertex before ignored ones";
  EXPECT_EQ(name_of(map_, 4), "none");
  EXPECT_EQ(name_of(other, 1), "none");
  EXPECT_EQ(find_image(db, map_, "1")->ignored_reason, IgnoredReason::kTooSimilar);
  EXPECT_EQ(find_image(db, map_, "2")->ignored_reason, IgnoredReason::kIdentical);
  EXPECT_EQ(find_image(db, map_, "2")->reason, Reason::kNone);
  db.connection().execute("UPDATE images SET deleted_at_us = 1 WHERE name = '0'");
  EXPECT_EQ(name_of(map_, 1), "none");
}

TEST_F(VertexStoreTest, ANameIsUniqueAmongVerticesAndIgnoredImagesOfItsMap) {
  test::add_vertex(store_, map_, vocabulary_, "x", {320, 240, {}});
  {
    WriteTransaction db = store_.write();
    EXPECT_THROW(insert_ignored(db, map_, test::new_image("x", {}), VertexId{0}, 200), StoreError);
  }
  EXPECT_THROW(test::add_vertex(store_, map_, vocabulary_, "x", {320, 240, {}}), StoreError);
  const MapId other = test::add_map(store_, "b", vocabulary_);
  EXPECT_EQ(test::add_vertex(store_, other, vocabulary_, "x", {320, 240, {}}), VertexId{0});
  EXPECT_EQ(find_map(store_.read(), map_)->revision, 1U);  // the refused ones left no trace
}

TEST_F(VertexStoreTest, NumbersCountFromZeroWithoutGapsThoughInsertionsAreAbandoned) {
  for (std::uint32_t i = 0; i < 20; ++i) {
    {
      WriteTransaction db = store_.write();
      insert_vertex(db, map_, vocabulary_, test::new_image("abandoned", {}), {320, 240, {}}, {},
                    test::test_verifier(db));
    }
    EXPECT_EQ(test::add_vertex(store_, map_, vocabulary_, std::to_string(i), {320, 240, {}}), VertexId{i});
  }
}

TEST_F(VertexStoreTest, AVertexHasItsEdges) {
  const AppearanceVector appearances = test::random_appearances(random_, 50, 1'000);
  for (int i = 0; i < 3; ++i) test::add_vertex(store_, map_, vocabulary_, std::to_string(i), appearances);
  std::vector<NewEdge> edges;
  for (const std::uint32_t u : {2U, 0U}) {
    edges.push_back({VertexId{u}, VertexId{77}, 40 + u, test::random_verification(random_, 20, 50, 50)});
  }
  WriteTransaction db = store_.write();
  const VertexId v = insert_vertex(db, map_, vocabulary_, test::new_image("3", appearances), appearances, edges,
                                   test::test_verifier(db));
  db.commit();
  const ReadTransaction reader = store_.read();
  const auto stored = list_own_edges_at(reader, map_, v);
  ASSERT_EQ(stored.size(), 2U);
  EXPECT_EQ(stored[0].u, VertexId{2});
  EXPECT_EQ(stored[0].v, v);
  EXPECT_EQ(stored[1].u, VertexId{0});
  EXPECT_EQ(stored[1].votes, 40U);
  EXPECT_EQ(find_map(reader, map_)->edges, 2U);
}

TEST_F(VertexStoreTest, RangesOfAppearancesComeBackInOrder) {
  std::vector<AppearanceVector> images;
  for (int i = 0; i < 30; ++i) {
    images.push_back(test::random_appearances(random_, static_cast<int>(random_.below(100)), 1'000));
    test::add_vertex(store_, map_, vocabulary_, std::to_string(i), images.back());
  }
  const ReadTransaction reader = store_.read();
  EXPECT_EQ(load_appearances(reader, map_, vocabulary_, VertexId{0}, 30), images);
  EXPECT_EQ(load_appearances(reader, map_, vocabulary_, VertexId{7}, 2), (std::vector{images[7], images[8]}));
  EXPECT_TRUE(load_appearances(reader, map_, vocabulary_, VertexId{30}, 0).empty());
  EXPECT_THROW(load_appearances(reader, map_, vocabulary_, VertexId{29}, 2), std::out_of_range);
  EXPECT_THROW(load_appearances(reader, map_, VocabularyId{9}, VertexId{0}, 1), std::out_of_range);
}

TEST_F(VertexStoreTest, ADamagedBlobIsTold) {
  test::add_vertex(store_, map_, vocabulary_, "0", test::random_appearances(random_, 40, 1'000));
  WriteTransaction db = store_.write();
  db.connection().execute("UPDATE appearances SET bytes = CAST(substr(bytes, 1, length(bytes) - 1) || x'FF' AS BLOB)");
  try {
    load_appearances(db, map_, vocabulary_, VertexId{0});
    FAIL();
  } catch (const StoreError& error) {
    EXPECT_EQ(error.kind(), StoreErrorKind::kCorrupt);
  }
}

TEST_F(VertexStoreTest, AMergedMapShowsItsMembersVerticesUnderItsOwnNumbers) {
  const MapId other = test::add_map(store_, "b", vocabulary_);
  for (int i = 0; i < 5; ++i) test::add_vertex(store_, map_, vocabulary_, std::to_string(i), {320, 240, {}});
  for (int i = 0; i < 4; ++i) test::add_vertex(store_, other, vocabulary_, std::to_string(i), {320, 240, {}});
  MapId merged{};
  {
    WriteTransaction db = store_.write();
    merged = insert_merged_map(db, test::new_map("ab", vocabulary_), std::vector{map_, other});
    db.commit();
  }
  test::add_vertex(store_, map_, vocabulary_, "later", {320, 240, {}});
  const ReadTransaction reader = store_.read();
  const MapLayout layout = load_layout(reader, merged);
  std::vector<VertexRow> read;
  std::optional<VertexId> after;
  do {
    const auto page = list_vertices(reader, layout, 2, after);
    if (page.empty()) break;
    read.insert(read.end(), page.begin(), page.end());
    after = page.back().vertex;
  } while (true);
  ASSERT_EQ(read.size(), 9U);
  for (std::uint32_t v = 0; v < 9; ++v) {
    EXPECT_EQ(read[v].vertex, VertexId{v});
    EXPECT_EQ(read[v].image.map, v < 5 ? map_ : other);
    EXPECT_EQ(read[v].image.vertex, VertexId{v < 5 ? v : v - 5});
  }
  const auto named = find_vertices(reader, layout, "3");
  ASSERT_EQ(named.size(), 2U);
  EXPECT_EQ(named[0].vertex, VertexId{3});
  EXPECT_EQ(named[1].vertex, VertexId{8});
  EXPECT_TRUE(find_vertices(reader, layout, "later").empty());
  EXPECT_TRUE(list_vertices(reader, layout, 0).empty());
}

TEST_F(VertexStoreTest, AMergedMapTakesNoImages) {
  const MapId other = test::add_map(store_, "b", vocabulary_);
  WriteTransaction db = store_.write();
  const MapId merged = insert_merged_map(db, test::new_map("ab", vocabulary_), std::vector{map_, other});
  EXPECT_THROW(
      insert_vertex(db, merged, vocabulary_, test::new_image("0", {}), {320, 240, {}}, {}, test::test_verifier(db)),
      StoreError);
}

}  // namespace
}  // namespace mapweld
