#include "core/retrieval/inverted_index.h"

#include <map>
#include <stdexcept>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/errors.h"
#include "tests/core/retrieval/random_images.h"

namespace mapweld {
namespace {

using ::testing::ElementsAre;
using ::testing::ElementsAreArray;
using ::testing::IsEmpty;

constexpr std::uint32_t kWords = 40;

// word -> postings, by counting every image on its own.
std::map<WordId, std::vector<Posting>> counted(const std::vector<AppearanceVector>& images, std::uint32_t first = 0) {
  std::map<WordId, std::vector<Posting>> all;
  for (std::size_t v = 0; v < images.size(); ++v) {
    std::map<WordId, int> counts;
    for (const Appearance& a : images[v].appearances) ++counts[a.word];
    for (const auto& [word, count] : counts) {
      all[word].push_back({VertexId{first + static_cast<std::uint32_t>(v)}, static_cast<std::uint16_t>(count)});
    }
  }
  return all;
}

struct Segment {
  std::vector<WordId> words;
  std::vector<std::uint32_t> offsets{0};
  std::vector<Posting> postings;
};

Segment segment_of(const std::vector<AppearanceVector>& images, std::uint32_t first) {
  Segment s;
  for (const auto& [word, list] : counted(images, first)) {
    s.words.push_back(word);
    s.postings.insert(s.postings.end(), list.begin(), list.end());
    s.offsets.push_back(static_cast<std::uint32_t>(s.postings.size()));
  }
  return s;
}

void expect_holds(const InvertedIndex& index, const std::vector<AppearanceVector>& images) {
  EXPECT_EQ(index.vertices(), images.size());
  const auto truth = counted(images);
  for (std::uint32_t w = 0; w < kWords + 2; ++w) {
    const auto it = truth.find(WordId{w});
    EXPECT_THAT(index.postings(WordId{w}), ElementsAreArray(it == truth.end() ? std::vector<Posting>{} : it->second));
  }
}

TEST(InvertedIndex, HoldsWhatWasAdded) {
  const auto images = test::random_map(1, 60, kWords, 50);
  InvertedIndex index;
  for (const AppearanceVector& image : images) index.add(image);
  expect_holds(index, images);
}

TEST(InvertedIndex, ImageWithoutFeaturesIsAVertexToo) {
  InvertedIndex index;
  index.add({});
  index.add({.width_px = 1, .height_px = 1, .appearances = {{.word = WordId{3}}}});
  EXPECT_EQ(index.vertices(), 2u);
  EXPECT_THAT(index.postings(WordId{3}), ElementsAre(Posting{VertexId{1}, 1}));
  EXPECT_THAT(index.postings(WordId{99999}), IsEmpty());
}

TEST(InvertedIndex, SegmentsAndSingleVerticesMix) {
  const auto images = test::random_map(2, 50, kWords, 30);
  InvertedIndex index;
  for (int i = 0; i < 10; ++i) index.add(images[i]);
  const std::vector<AppearanceVector> middle(images.begin() + 10, images.begin() + 40);
  const Segment s = segment_of(middle, 10);
  index.add_segment(10, 30, s.words, s.offsets, s.postings);
  for (int i = 40; i < 50; ++i) index.add(images[i]);
  expect_holds(index, images);
}

TEST(InvertedIndex, TruncateForgetsTheNewest) {
  auto images = test::random_map(3, 50, kWords, 30);
  InvertedIndex index;
  for (const AppearanceVector& image : images) index.add(image);
  index.truncate(17);
  images.resize(17);
  expect_holds(index, images);
  index.truncate(100);
  expect_holds(index, images);
  index.add(images[3]);
  images.push_back(images[3]);
  expect_holds(index, images);
}

TEST(InvertedIndex, ViewAppendAndSpanAgree) {
  const auto images = test::random_map(4, 30, kWords, 30);
  InvertedIndex index;
  for (const AppearanceVector& image : images) index.add(image);
  const PostingSource& source = index;
  for (std::uint32_t w = 0; w < kWords; ++w) {
    std::vector<Posting> appended{{VertexId{7}, 7}};
    std::vector<Posting> scratch;
    source.postings(WordId{w}, appended);
    EXPECT_EQ(appended.front(), (Posting{VertexId{7}, 7}));
    appended.erase(appended.begin());
    EXPECT_THAT(source.view(WordId{w}, scratch), ElementsAreArray(appended));
    EXPECT_THAT(source.PostingSource::view(WordId{w}, scratch), ElementsAreArray(appended));
  }
}

TEST(InvertedIndex, RefusesTornSegmentsUnchanged) {
  const auto images = test::random_map(5, 10, kWords, 30);
  InvertedIndex index;
  for (const AppearanceVector& image : images) index.add(image);
  const Segment good = segment_of(test::random_map(6, 10, kWords, 30), 10);
  const auto refused = [&](Segment s, std::uint32_t first = 10, std::uint32_t count = 10) {
    EXPECT_THROW(index.add_segment(first, count, s.words, s.offsets, s.postings), FormatError);
  };
  refused(good, 9);
  refused(good, 11);
  refused(good, 10, 3);
  Segment s = good;
  s.offsets.pop_back();
  refused(s);
  s = good;
  s.postings.pop_back();
  refused(s);
  s = good;
  std::swap(s.words[0], s.words[1]);
  refused(s);
  s = good;
  s.words[1] = s.words[0];
  refused(s);
  s = good;
  std::swap(s.postings[0], s.postings[1]);
  refused(s);
  s = good;
  s.offsets[1] = s.offsets[2] + 1;
  refused(s);
  refused({.words = {}, .offsets = {}, .postings = {}});
  expect_holds(index, images);
}

TEST(InvertedIndex, RefusesUnsortedAppearances) {
  InvertedIndex index;
  const AppearanceVector unsorted{
      .width_px = 1, .height_px = 1, .appearances = {{.word = WordId{2}}, {.word = WordId{1}}}};
  EXPECT_THROW(index.add(unsorted), std::invalid_argument);
  EXPECT_EQ(index.vertices(), 0u);
}

TEST(InvertedIndex, MemoryGrowsWithPostings) {
  InvertedIndex index;
  const std::size_t empty = index.memory_bytes();
  std::size_t postings = 0;
  for (const AppearanceVector& image : test::random_map(7, 100, kWords, 50)) {
    index.add(image);
    for (const auto& [word, list] : counted({image})) postings += list.size();
  }
  EXPECT_GE(index.memory_bytes(), empty + postings * sizeof(Posting));
}

}  // namespace
}  // namespace mapweld
