#include "core/retrieval/inverted_index.h"

#include <algorithm>
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

// word -> postings, feature by feature.
std::map<WordId, PostingList> posted(const std::vector<AppearanceVector>& images, std::uint32_t first = 0) {
  std::map<WordId, PostingList> all;
  for (std::size_t v = 0; v < images.size(); ++v) {
    for (const Appearance& a : images[v].appearances) {
      all[a.word].add(VertexId{first + static_cast<std::uint32_t>(v)}, vote_signature(a.signature));
    }
  }
  return all;
}

struct Segment {
  std::vector<WordId> words;
  std::vector<std::uint32_t> offsets{0};
  PostingList postings;
};

Segment segment_of(const std::vector<AppearanceVector>& images, std::uint32_t first) {
  Segment s;
  for (const auto& [word, list] : posted(images, first)) {
    s.words.push_back(word);
    s.postings.append(list);
    s.offsets.push_back(static_cast<std::uint32_t>(s.postings.size()));
  }
  return s;
}

void expect_holds(const InvertedIndex& index, const std::vector<AppearanceVector>& images) {
  EXPECT_EQ(index.vertices(), images.size());
  const auto truth = posted(images);
  for (std::uint32_t w = 0; w < kWords + 2; ++w) {
    const auto it = truth.find(WordId{w});
    EXPECT_EQ(index.postings(WordId{w}), it == truth.end() ? PostingList{} : it->second);
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
  EXPECT_THAT(index.postings(WordId{3}).vertices, ElementsAre(VertexId{1}));
  EXPECT_THAT(index.postings(WordId{99999}).vertices, IsEmpty());
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

TEST(InvertedIndex, ShowsTheSameAsItFinds) {
  InvertedIndex index;
  for (const AppearanceVector& image : test::random_map(4, 30, kWords, 30)) index.add(image);
  for (std::uint32_t w = 0; w < kWords + 2; ++w) {
    const PostingSpan found = index.find(WordId{w});
    const PostingList shown = index.postings(WordId{w});
    EXPECT_THAT(shown.vertices, ElementsAreArray(found.vertices));
    EXPECT_THAT(shown.signatures, ElementsAreArray(found.signatures));
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
  s.postings.resize(s.postings.size() - 1);
  refused(s);
  s = good;
  std::swap(s.words[0], s.words[1]);
  refused(s);
  s = good;
  s.words[1] = s.words[0];
  refused(s);
  s = good;
  std::ranges::reverse(s.postings.vertices);
  refused(s);
  s = good;
  s.offsets[1] = s.offsets[2] + 1;
  refused(s);
  s = good;
  s.postings.signatures.pop_back();
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
    postings += image.appearances.size();
  }
  EXPECT_GE(index.memory_bytes(), empty + postings * kBytesPerPosting);
}

}  // namespace
}  // namespace mapweld
