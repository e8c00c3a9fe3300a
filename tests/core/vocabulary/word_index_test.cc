#include "core/vocabulary/word_index.h"

#include <string>
#include <thread>

#include <gtest/gtest.h>

#include "core/errors.h"
#include "core/vocabulary/hnsw_graph.h"
#include "tests/core/vocabulary/descriptor_sets.h"

namespace mapweld {
namespace {

using Rows = std::vector<std::uint8_t>;

constexpr std::size_t kWords = 3000;
constexpr std::size_t kQueries = 300;

std::vector<WordId> quantise(const WordIndex& index, const Rows& queries) {
  std::vector<WordId> words(queries.size() / kDescriptorDimension);
  index.quantise(queries, words);
  return words;
}

double recall(const std::vector<WordId>& found, const Rows& queries, const Rows& centroids) {
  std::size_t right = 0;
  for (std::size_t i = 0; i < found.size(); ++i) {
    right += to_index(found[i]) == test::nearest_row(queries.data() + i * kDescriptorDimension, centroids);
  }
  return static_cast<double>(right) / static_cast<double>(found.size());
}

class WordIndexEngines : public testing::TestWithParam<const char*> {
 protected:
  static const Rows& centroids() {
    static const Rows rows = test::clustered_descriptors(kWords, 100, 60, 1);
    return rows;
  }
  static const Rows& queries() {
    static const Rows rows = test::clustered_descriptors(kQueries, 100, 60, 2);
    return rows;
  }
  static std::unique_ptr<WordIndex> build(const Rows& rows) {
    WordIndexOptions options;
    options.engine = GetParam();
    return build_word_index(rows, options);
  }
};

TEST_P(WordIndexEngines, FindTheNearestWord) {
  const auto index = build(centroids());
  EXPECT_EQ(index->engine(), GetParam());
  const double share = recall(quantise(*index, queries()), queries(), centroids());
  EXPECT_GE(share, index->engine() == "exact" ? 1.0 : 0.97);
}

TEST_P(WordIndexEngines, FindEveryWordByItself) {
  const auto found = quantise(*build(centroids()), centroids());
  std::size_t right = 0;
  for (std::size_t i = 0; i < found.size(); ++i) right += to_index(found[i]) == i;
  EXPECT_GE(static_cast<double>(right), 0.995 * kWords);
}

TEST_P(WordIndexEngines, GiveTiesToTheLowerWord) {
  Rows twice = test::clustered_descriptors(40, 40, 20, 9);
  twice.insert(twice.end(), twice.begin(), twice.end());
  const auto found = quantise(*build(twice), twice);
  for (std::size_t i = 0; i < found.size(); ++i) EXPECT_EQ(to_index(found[i]), i % 40);
}

TEST_P(WordIndexEngines, TakeVocabulariesOfAnySize) {
  for (const std::size_t words : {1, 2, 3, 33, 100}) {
    const Rows rows = test::clustered_descriptors(words, 5, 60, words);
    const auto found = quantise(*build(rows), queries());
    EXPECT_GE(recall(found, queries(), rows), 0.97) << words;
  }
}

TEST_P(WordIndexEngines, QuantiseAlikeWhenBuiltAgain) {
  EXPECT_EQ(quantise(*build(centroids()), queries()), quantise(*build(centroids()), queries()));
  EXPECT_EQ(build(centroids())->serialize(), build(centroids())->serialize());
}

TEST_P(WordIndexEngines, QuantiseAlikeWhenLoaded) {
  const auto built = build(centroids());
  const auto bytes = built->serialize();
  const auto loaded = load_word_index(centroids(), GetParam(), bytes);
  EXPECT_EQ(quantise(*loaded, queries()), quantise(*built, queries()));
  EXPECT_EQ(loaded->serialize(), bytes);
}

TEST_P(WordIndexEngines, QuantiseAlikeInAnyCompany) {
  const auto index = build(centroids());
  const auto expected = quantise(*index, queries());
  std::vector<std::vector<WordId>> found(4);
  {
    std::vector<std::jthread> threads;
    for (auto& words : found) threads.emplace_back([&] { words = quantise(*index, queries()); });
  }
  for (const auto& words : found) EXPECT_EQ(words, expected);
  // One at a time, and backwards.
  for (std::size_t i = kQueries; i-- > 0;) {
    WordId word{};
    index->quantise(std::span(queries()).subspan(i * kDescriptorDimension, kDescriptorDimension), {&word, 1});
    ASSERT_EQ(word, expected[i]);
  }
}

INSTANTIATE_TEST_SUITE_P(, WordIndexEngines, testing::Values("hnsw", "flann", "exact"),
                         [](const auto& info) { return std::string(info.param); });

TEST(WordIndex, RefusesEnginesNobodyKnows) {
  const Rows rows(kDescriptorDimension);
  WordIndexOptions options;
  options.engine = "guess";
  EXPECT_THROW(build_word_index(rows, options), FormatError);
  EXPECT_THROW(load_word_index(rows, "guess", {}), FormatError);
  options.engine = "exact";
  EXPECT_THROW(build_word_index(Rows(100), options), FormatError);
}

TEST(HnswGraph, SurvivesItsBytes) {
  const Rows rows = test::clustered_descriptors(2000, 50, 60, 4);
  const HnswGraph graph = build_hnsw_graph(rows, {});
  EXPECT_GT(graph.levels.size(), 1u);
  EXPECT_EQ(decode_hnsw_graph(encode_hnsw_graph(graph), 2000), graph);
}

TEST(HnswGraph, NoBytesLeadASearchAstray) {
  const Rows rows = test::clustered_descriptors(300, 20, 60, 4);
  WordIndexOptions options;
  const auto bytes = build_word_index(rows, options)->serialize();
  for (std::size_t size = 0; size < bytes.size(); size += 7) {
    EXPECT_THROW(load_word_index(rows, "hnsw", std::span(bytes).first(size)), FormatError);
  }
  const Rows queries = test::clustered_descriptors(5, 20, 60, 5);
  SplitMix64 random(1);
  int loaded = 0;
  for (int i = 0; i < 3000; ++i) {
    auto broken = bytes;
    for (std::uint64_t k = 0; k <= random.below(3); ++k) {
      broken[random.below(broken.size())] = static_cast<std::uint8_t>(random.below(256));
    }
    try {
      const auto index = load_word_index(rows, "hnsw", broken);
      for (const WordId word : quantise(*index, queries)) EXPECT_LT(to_index(word), 300u);
      ++loaded;
    } catch (const FormatError&) {
    }
  }
  EXPECT_GT(loaded, 0) << "nothing got as far as a search";
  EXPECT_THROW(load_word_index(std::span(rows).first(100 * kDescriptorDimension), "hnsw", bytes), FormatError);
}

}  // namespace
}  // namespace mapweld
