#include "core/vocabulary/vocabulary.h"

#include <stdexcept>

#include <gtest/gtest.h>

#include "core/errors.h"
#include "core/vocabulary/foreign_vocabulary.h"
#include "tests/core/vocabulary/descriptor_sets.h"

namespace mapweld {
namespace {

using Bytes = std::vector<std::uint8_t>;

Features features_of(Bytes descriptors) {
  Features features;
  features.keypoints.resize(descriptors.size() / kDescriptorDimension);
  features.descriptors = std::move(descriptors);
  return features;
}

TEST(Vocabulary, SurvivesItsFile) {
  const Bytes centroids = test::clustered_descriptors(700, 50, 60, 1);
  const Features features = features_of(test::clustered_descriptors(300, 50, 60, 2));
  for (const char* engine : {"hnsw", "flann", "exact"}) {
    WordIndexOptions options;
    options.engine = engine;
    const Vocabulary vocabulary(centroids, options);
    EXPECT_EQ(vocabulary.words(), 700u);
    const Bytes file = vocabulary.serialize();
    const auto restored = Vocabulary::deserialize(file);
    EXPECT_EQ(restored->words(), 700u);
    EXPECT_TRUE(
        std::equal(restored->centroids().begin(), restored->centroids().end(), centroids.begin(), centroids.end()));
    EXPECT_EQ(restored->index().engine(), engine);
    EXPECT_EQ(restored->quantise(features), vocabulary.quantise(features));
    EXPECT_EQ(restored->serialize(), file);
  }
}

// FLANN would overwrite memory where a hostile archive tells it to: none is read.
TEST(Vocabulary, OfOthersHasAFlannIndexOfItsOwnWordsOnly) {
  const Bytes centroids = test::clustered_descriptors(700, 50, 60, 1);
  const Features features = features_of(test::clustered_descriptors(300, 50, 60, 2));
  for (const char* engine : {"hnsw", "flann", "exact"}) {
    WordIndexOptions options;
    options.engine = engine;
    const Vocabulary vocabulary(centroids, options);
    const auto foreign = deserialize_foreign(vocabulary.serialize());
    EXPECT_EQ(foreign->quantise(features), vocabulary.quantise(features)) << engine;
    EXPECT_EQ(foreign->serialize(), vocabulary.serialize()) << engine;
  }
  WordIndexOptions other;
  other.engine = "flann";
  other.seed = 2;
  const Bytes file = Vocabulary(centroids, other).serialize();
  EXPECT_NO_THROW(Vocabulary::deserialize(file));
  EXPECT_THROW(deserialize_foreign(file), FormatError);
  EXPECT_THROW(deserialize_foreign(std::span(file).first(file.size() / 2)), FormatError);
}

TEST(Vocabulary, GivesAWordAFeature) {
  const Bytes centroids = test::clustered_descriptors(500, 50, 0, 1);
  const Vocabulary vocabulary(centroids, {});
  const Features features = features_of(test::clustered_descriptors(100, 50, 5, 1));
  const auto words = vocabulary.quantise(features);
  ASSERT_EQ(words.size(), 100u);
  for (std::size_t i = 0; i < words.size(); ++i) {
    EXPECT_EQ(to_index(words[i]), test::nearest_row(features.descriptors.data() + i * kDescriptorDimension, centroids));
  }
  EXPECT_TRUE(vocabulary.quantise({}).empty());
}

TEST(Vocabulary, CopiesShareOneIndex) {
  const Features features = features_of(test::clustered_descriptors(10, 5, 5, 1));
  auto vocabulary = std::make_unique<Vocabulary>(test::clustered_descriptors(50, 50, 0, 1), WordIndexOptions{});
  const auto words = vocabulary->quantise(features);
  const Vocabulary copy = *vocabulary;
  vocabulary.reset();
  EXPECT_EQ(copy.quantise(features), words);
}

TEST(Vocabulary, NoticesEveryChangedByte) {
  const Bytes file = Vocabulary(test::clustered_descriptors(60, 10, 60, 1), {}).serialize();
  std::size_t noticed = 0;
  for (std::size_t i = 0; i < file.size(); ++i) {
    Bytes broken = file;
    broken[i] ^= static_cast<std::uint8_t>(1u << (i % 8));
    try {
      // zstd's frame has bits that mean nothing; a file may differ in them and say the same.
      EXPECT_EQ(Vocabulary::deserialize(broken)->serialize(), file) << "byte " << i;
    } catch (const FormatError&) {
      ++noticed;
    }
  }
  EXPECT_GT(noticed, file.size() * 99 / 100);
}

TEST(Vocabulary, NoticesMissingAndSurplusBytes) {
  const Bytes file = Vocabulary(test::clustered_descriptors(60, 10, 60, 1), {}).serialize();
  for (std::size_t size = 0; size < file.size(); size += 13) {
    EXPECT_THROW(Vocabulary::deserialize(std::span(file).first(size)), FormatError) << size;
  }
  Bytes longer = file;
  longer.push_back(0);
  EXPECT_THROW(Vocabulary::deserialize(longer), FormatError);
}

TEST(Vocabulary, RefusesForeignAndNewerFiles) {
  EXPECT_THROW(Vocabulary::deserialize(Bytes(1000, 7)), FormatError);
  Bytes newer = Vocabulary(test::clustered_descriptors(60, 10, 60, 1), {}).serialize();
  newer[8] = 2;  // the format's number follows the magic
  try {
    Vocabulary::deserialize(newer);
    FAIL();
  } catch (const FormatError& error) {
    EXPECT_NE(std::string(error.what()).find("format 2"), std::string::npos) << error.what();
  }
}

TEST(Vocabulary, NeedsWordsAndWholeDescriptors) {
  EXPECT_THROW(Vocabulary({}, {}), FormatError);
  EXPECT_THROW(Vocabulary(Bytes(200), {}), FormatError);
  Features features;
  features.keypoints.resize(2);
  features.descriptors.resize(kDescriptorDimension);
  EXPECT_THROW(Vocabulary(Bytes(kDescriptorDimension), {}).quantise(features), std::invalid_argument);
}

}  // namespace
}  // namespace mapweld
