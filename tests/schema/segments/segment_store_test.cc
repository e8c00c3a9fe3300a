#include "schema/segments/segment_store.h"

#include <atomic>
#include <thread>

#include <gtest/gtest.h>

#include "core/retrieval/voting.h"
#include "schema/merges/merge_store.h"
#include "tests/support/temp_store.h"

namespace mapweld {
namespace {

using test::Random;
using test::TempStore;

constexpr std::uint32_t kWords = 400;

void expect_same(const PostingSource& source, const InvertedIndex& expected) {
  ASSERT_EQ(source.vertices(), expected.vertices());
  for (std::uint32_t word = 0; word < kWords; ++word) {
    ASSERT_EQ(source.postings(WordId{word}), expected.postings(WordId{word})) << "word " << word;
  }
}

class SegmentStoreTest : public testing::Test {
 protected:
  AppearanceVector grow(MapId map) {
    // Some images have no feature; some words appear often in one image.
    const int features = random_.chance(0.1) ? 0 : static_cast<int>(random_.below(80));
    const AppearanceVector image = test::random_appearances(random_, features, kWords, random_.chance(0.8));
    test::add_vertex(store_, map, vocabulary_, std::to_string(images_[map].size()), image);
    images_[map].push_back(image);
    return image;
  }

  InvertedIndex expected(const MapLayout& layout) {
    InvertedIndex index;
    for (std::uint32_t v = 0; v < layout.vertices(); ++v) {
      const LeafVertex leaf = layout.leaf(VertexId{v});
      index.add(images_.at(leaf.map).at(to_index(leaf.vertex)));
    }
    return index;
  }

  void expect_all_agree(MapId map) {
    const ReadTransaction reader = store_.read();
    const MapLayout layout = load_layout(reader, map);
    const InvertedIndex index = expected(layout);
    expect_same(load_index(reader, layout, vocabulary_), index);
    expect_same(SegmentPostingSource(reader, layout, vocabulary_), index);
  }

  TempStore store_;
  Random random_{41};
  VocabularyId vocabulary_ = test::add_vocabulary(store_, "words", kWords);
  MapId map_ = test::add_map(store_, "a", vocabulary_);
  std::map<MapId, std::vector<AppearanceVector>> images_;
};

TEST_F(SegmentStoreTest, TheIndexIsThatOfTheAppearancesWhateverTheSegments) {
  expect_all_agree(map_);
  for (int i = 0; i < 150; ++i) {
    grow(map_);
    if (random_.chance(0.1)) {
      const SegmentOptions options{1 + static_cast<std::uint32_t>(random_.below(12)),
                                   2 + static_cast<std::uint32_t>(random_.below(3)),
                                   static_cast<std::uint32_t>(random_.below(100))};
      write_due_segments(store_, options);
      expect_all_agree(map_);
    }
  }
  expect_all_agree(map_);
  WriteTransaction db = store_.write();
  drop_segments(db, map_, vocabulary_);
  db.commit();
  expect_all_agree(map_);
}

TEST_F(SegmentStoreTest, SegmentsFillMergeAndLeaveTheNewestToTheAppearances) {
  for (int i = 0; i < 37; ++i) grow(map_);
  const SegmentOptions options{4, 3, 36};
  const SegmentStatistics statistics = write_due_segments(store_, options);
  // Nine segments of 4 become three of 12, these one of 36; one vertex is left over.
  EXPECT_EQ(statistics.written, 9U + 3U + 1U);
  EXPECT_EQ(statistics.merged, 9U + 3U);
  const auto segments = list_segments(store_.read(), map_, vocabulary_);
  ASSERT_EQ(segments.size(), 1U);
  EXPECT_EQ(segments[0].count, 36U);
  EXPECT_EQ(write_due_segments(store_, options).written, 0U);
  expect_all_agree(map_);
}

TEST_F(SegmentStoreTest, MergedMapsAreIndexedThroughTheirMembersSegments) {
  const MapId b = test::add_map(store_, "b", vocabulary_);
  const MapId c = test::add_map(store_, "c", vocabulary_);
  for (int i = 0; i < 23; ++i) grow(map_);
  for (int i = 0; i < 17; ++i) grow(b);
  for (int i = 0; i < 9; ++i) grow(c);
  MapId ab{};
  MapId cab{};
  {
    WriteTransaction db = store_.write();
    ab = insert_merged_map(db, test::new_map("ab", vocabulary_), std::vector{map_, b});
    cab = insert_merged_map(db, test::new_map("cab", vocabulary_), std::vector{c, ab});
    db.commit();
  }
  for (int i = 0; i < 14; ++i) grow(map_);
  for (int i = 0; i < 3; ++i) grow(b);
  const SegmentOptions options{5, 3, 15};
  for (const bool with_segments : {false, true}) {
    if (with_segments) write_due_segments(store_, options);
    expect_all_agree(ab);
    expect_all_agree(cab);
  }
  WriteTransaction db = store_.write();
  extend_merged_map(db, ab);
  extend_merged_map(db, cab);
  db.commit();
  expect_all_agree(ab);
  expect_all_agree(cab);
}

TEST_F(SegmentStoreTest, VotesAreTheSameFromSegmentsAndFromMemory) {
  for (int i = 0; i < 60; ++i) grow(map_);
  write_due_segments(store_, {8, 4, 32});
  const ReadTransaction reader = store_.read();
  const MapLayout layout = load_layout(reader, map_);
  const InvertedIndex index = load_index(reader, layout, vocabulary_);
  const SegmentPostingSource source(reader, layout, vocabulary_);
  for (int q = 0; q < 20; ++q) {
    const AppearanceVector query = test::random_appearances(random_, 100, kWords, q % 5 != 0);
    for (const VoteRule rule : {VoteRule::kMin, VoteRule::kProduct, VoteRule::kSignatures}) {
      const Votes memory = vote(query, index, rule, 3);
      const Votes stored = vote(query, source, rule, 3);
      EXPECT_EQ(memory.candidates, stored.candidates);
      EXPECT_EQ(memory.known_words, stored.known_words);
      EXPECT_FALSE(memory.candidates.empty());
    }
  }
}

TEST_F(SegmentStoreTest, UploadsDeletionsAndSegmentsGoOnAtOnce) {
  const MapId doomed = test::add_map(store_, "doomed", vocabulary_);
  for (int i = 0; i < 40; ++i) grow(doomed);
  std::atomic<bool> stop = false;
  std::thread background([&] {
    while (!stop) write_due_segments(store_, {4, 3, 36});
  });
  for (int i = 0; i < 120; ++i) {
    grow(map_);
    if (i == 60) {
      WriteTransaction db = store_.write();
      EXPECT_EQ(delete_map(db, doomed), DeleteOutcome::kDeleted);
      db.commit();
    }
    if (i % 10 == 0) expect_all_agree(map_);
  }
  stop = true;
  background.join();
  write_due_segments(store_, {4, 3, 36});
  expect_all_agree(map_);
  EXPECT_EQ(store_.read().connection().query_integer(
                "SELECT count(*) FROM posting_blocks WHERE segment NOT IN (SELECT id FROM segments)"),
            0);
}

TEST_F(SegmentStoreTest, ASegmentThatComesTooLateIsNotStored) {
  for (int i = 0; i < 60; ++i) grow(map_);
  for (int round = 0; round < 10; ++round) {
    std::vector<std::thread> writers;
    for (int t = 0; t < 3; ++t) {
      writers.emplace_back([&] { EXPECT_NO_THROW(write_due_segments(store_, {3, 3, 27})); });
    }
    for (std::thread& writer : writers) writer.join();
    expect_all_agree(map_);
    WriteTransaction db = store_.write();
    drop_segments(db, map_, vocabulary_);
    db.commit();
  }
}

TEST_F(SegmentStoreTest, DamageIsTold) {
  for (int i = 0; i < 8; ++i) grow(map_);
  write_due_segments(store_, {8, 2, 8});
  WriteTransaction db = store_.write();
  db.connection().execute("UPDATE posting_blocks SET bytes = CAST(x'500100000000' || substr(bytes, 7) AS BLOB)");
  EXPECT_THROW(load_index(db, map_, vocabulary_), StoreError);
}

}  // namespace
}  // namespace mapweld
