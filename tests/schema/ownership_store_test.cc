#include "schema/ownership_store.h"

#include <gtest/gtest.h>
#include <openssl/sha.h>

#include "schema/maps/map_store.h"
#include "schema/maps/purge.h"
#include "schema/maps/vertex_removal.h"
#include "schema/merges/merge_store.h"
#include "schema/store_check.h"
#include "tests/support/temp_store.h"

namespace mapweld {
namespace {

using test::at;

class Ownership : public ::testing::Test {
 protected:
  template <typename Change>
  void write(const Change& change) {
    WriteTransaction db = store_.write();
    change(db);
    db.commit();
  }
  VertexId add(MapId map, const std::string& name, std::size_t bytes, std::optional<std::int64_t> owner) {
    const AppearanceVector appearances{320, 240, {}};
    const std::vector<std::uint8_t> content(bytes, 1);
    VertexId vertex{};
    write([&](WriteTransaction& db) {
      NewImage image = test::new_image(name, appearances);
      image.bytes = content;
      SHA256(content.data(), content.size(), image.sha256.data());
      image.owner = owner;
      vertex = insert_vertex(db, map, vocabulary_, image, appearances, {}, test::test_verifier(db));
    });
    return vertex;
  }
  KeyUsage usage(std::int64_t key) { return usage_of(store_.read(), key); }
  static KeyUsage has(std::int64_t images, std::int64_t bytes, std::int64_t merges = 0) {
    return {images, bytes, merges};
  }

  test::TempStore store_;
  VocabularyId vocabulary_ = test::add_vocabulary(store_);
  MapId a_ = test::add_map(store_, "a", vocabulary_);
  MapId b_ = test::add_map(store_, "b", vocabulary_);
};

TEST_F(Ownership, CountsWhatEachKeyHas) {
  add(a_, "0", 100, 1);
  add(a_, "1", 50, 2);
  add(b_, "0", 7, 1);
  add(b_, "1", 1'000, std::nullopt);
  EXPECT_EQ(usage(1), has(2, 107));
  EXPECT_EQ(usage(2), has(1, 50));
  EXPECT_EQ(usage(3), has(0, 0));
}

TEST_F(Ownership, DeletingGivesBackHoweverItComesAbout) {
  add(a_, "0", 100, 1);
  add(a_, "1", 20, 1);
  add(a_, "2", 3, 1);
  add(b_, "0", 5'000, 1);
  write([&](WriteTransaction& db) { delete_image_bytes(db, a_, VertexId{0}); });
  EXPECT_EQ(usage(1), has(4, 5'023));
  write([&](WriteTransaction& db) { delete_vertices(db, a_, VertexId{1}, 1, at(9)); });
  EXPECT_EQ(usage(1), has(3, 5'003));
  write([&](WriteTransaction& db) {
    restore_vertex(db, a_, VertexId{1});
    own_vertex(db, a_, VertexId{1}, 2);
    own_vertex(db, a_, VertexId{2}, 2);  // has an owner
  });
  EXPECT_EQ(usage(1), has(3, 5'003));
  EXPECT_EQ(usage(2), has(1, 20));
  write([&](WriteTransaction& db) {
    delete_vertices(db, a_, VertexId{1}, 1, at(9));
    purge_deleted(db, a_);
  });
  EXPECT_EQ(usage(2), has(0, 0));
  write([&](WriteTransaction& db) { delete_map(db, b_); });
  EXPECT_EQ(usage(1), has(2, 3));
  for (const Finding& finding : check_store(store_.read()).findings) {
    ADD_FAILURE() << finding.where << ": " << finding.what;
  }
}

TEST_F(Ownership, AMapsImagesCanBecomeAKeysAtOnce) {
  add(a_, "0", 100, std::nullopt);
  add(a_, "1", 10, 1);
  add(a_, "2", 1, std::nullopt);
  write([&](WriteTransaction& db) {
    delete_vertices(db, a_, VertexId{2}, 1, at(9));
    own_images_of(db, a_, 2);
  });
  EXPECT_EQ(usage(1), has(1, 10));
  EXPECT_EQ(usage(2), has(1, 100));
}

TEST_F(Ownership, OfMergesThoseCountThatWaitOrRun) {
  JobId job{};
  write([&](WriteTransaction& db) {
    const MapId merged = insert_merged_map(db, test::new_map("ab", vocabulary_), std::vector{a_, b_});
    job = insert_merge(db, {merged, "quickconnect", 7, "{}", "{}", at(3)});
    own_merge(db, job, 1);
  });
  EXPECT_EQ(usage(1), has(0, 0, 1));
  write([&](WriteTransaction& db) { claim_merge(db, job, at(4)); });
  EXPECT_EQ(usage(1), has(0, 0, 1));
  write([&](WriteTransaction& db) { own_merge(db, job, 2); });
  EXPECT_EQ(usage(1), has(0, 0, 0));
  EXPECT_EQ(usage(2), has(0, 0, 1));
  write([&](WriteTransaction& db) {
    set_merge_state(db, job, JobState::kRunning, {JobState::kPaused, "paused", std::nullopt, at(5)});
  });
  EXPECT_EQ(usage(2), has(0, 0, 0));
  write([&](WriteTransaction& db) {
    own_merge(db, job, 1);
    delete_merge(db, job);
  });
  EXPECT_EQ(store_.read().connection().query_integer("SELECT count(*) FROM owned_merges"), 0);
}

TEST_F(Ownership, ACheckComparesTheSums) {
  add(a_, "0", 100, 1);
  write([](WriteTransaction& db) { db.prepare("UPDATE key_usage SET bytes = bytes + 1").run(); });
  const auto findings = check_store(store_.read()).findings;
  ASSERT_EQ(findings.size(), 1u);
  EXPECT_EQ(findings[0].where, "key_usage: key 1");
}

}  // namespace
}  // namespace mapweld
