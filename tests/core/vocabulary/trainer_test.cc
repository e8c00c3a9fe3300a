#include "core/vocabulary/trainer.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <string>

#include <gtest/gtest.h>

#include "core/errors.h"
#include "tests/core/vocabulary/descriptor_sets.h"

namespace mapweld {
namespace {

using Rows = std::vector<std::uint8_t>;

TrainerOptions small_training(std::uint32_t words) {
  TrainerOptions options;
  options.words = words;
  options.start_sample = 2000;
  options.block = 500;
  return options;
}

// Lloyd's iteration straight from its definition, with real numbers, for clusters none of which is empty.
Rows plain_lloyd(const Rows& rows, const Rows& centroids) {
  std::vector<double> sums(centroids.size());
  std::vector<double> counts(centroids.size() / kDescriptorDimension);
  for (std::size_t i = 0; i < rows.size() / kDescriptorDimension; ++i) {
    const std::uint8_t* row = rows.data() + i * kDescriptorDimension;
    const std::uint32_t nearest = test::nearest_row(row, centroids);
    counts[nearest] += 1;
    for (std::size_t k = 0; k < kDescriptorDimension; ++k) sums[nearest * kDescriptorDimension + k] += row[k];
  }
  Rows moved(centroids.size());
  for (std::size_t i = 0; i < moved.size(); ++i) {
    EXPECT_GT(counts[i / kDescriptorDimension], 0);
    moved[i] = static_cast<std::uint8_t>(std::floor(sums[i] / counts[i / kDescriptorDimension] + 0.5));
  }
  return moved;
}

TEST(Trainer, AnIterationIsLloyds) {
  const Rows rows = test::clustered_descriptors(3000, 40, 50, 1);
  TrainerOptions options = small_training(40);
  options.index.engine = "exact";
  KMeansState state = start_kmeans(DescriptorSpan(rows), options);
  for (int i = 0; i < 3; ++i) {
    const auto next = iterate_kmeans(DescriptorSpan(rows), state, options);
    ASSERT_EQ(next->history.back().empty, 0u);
    EXPECT_EQ(next->centroids, plain_lloyd(rows, state.centroids));
    std::uint64_t distortion = 0;
    for (std::size_t row = 0; row < rows.size(); row += kDescriptorDimension) {
      const std::uint32_t nearest = test::nearest_row(rows.data() + row, state.centroids);
      distortion += static_cast<std::uint64_t>(
          test::squared_distance(rows.data() + row, state.centroids.data() + nearest * kDescriptorDimension));
    }
    EXPECT_EQ(next->history.back().distortion, distortion);
    state = *next;
  }
}

TEST(Trainer, DistortionFalls) {
  const Rows rows = test::clustered_descriptors(5000, 300, 70, 2);
  const TrainerOptions options = small_training(200);
  KMeansState state = start_kmeans(DescriptorSpan(rows), options);
  for (int i = 0; i < 6; ++i) state = *iterate_kmeans(DescriptorSpan(rows), state, options);
  for (std::size_t i = 1; i < state.history.size(); ++i) {
    EXPECT_LE(state.history[i].distortion, state.history[i - 1].distortion);
  }
  EXPECT_LT(state.history.back().distortion, 0.99 * static_cast<double>(state.history.front().distortion));
}

TEST(Trainer, SameCentroidsWhateverTheThreadsAndBlocks) {
  const Rows rows = test::clustered_descriptors(4000, 100, 60, 3);
  std::vector<Rows> results;
  for (const int threads : {1, 2, 5}) {
    for (const std::uint64_t block : {97, 1000, 100'000}) {
      TrainerOptions options = small_training(150);
      options.threads = threads;
      options.block = block;
      KMeansState state = start_kmeans(DescriptorSpan(rows), options);
      for (int i = 0; i < 2; ++i) state = *iterate_kmeans(DescriptorSpan(rows), state, options);
      results.push_back(state.centroids);
    }
  }
  for (const Rows& result : results) EXPECT_EQ(result, results.front());
}

TEST(Trainer, AnotherSeedIsAnotherStart) {
  const Rows rows = test::clustered_descriptors(4000, 100, 60, 3);
  TrainerOptions options = small_training(150);
  const KMeansState first = start_kmeans(DescriptorSpan(rows), options);
  EXPECT_EQ(start_kmeans(DescriptorSpan(rows), options), first);
  options.seed = 2;
  EXPECT_NE(start_kmeans(DescriptorSpan(rows), options), first);
}

TEST(Trainer, EmptyWordsGoWhereClustersAreWorst) {
  // Four tight groups; two centroids in one, none in the others but one far-off centroid that wins nothing.
  Rows rows;
  for (const int level : {10, 80, 150, 220}) {
    for (int i = 0; i < 20; ++i)
      rows.insert(rows.end(), kDescriptorDimension, static_cast<std::uint8_t>(level + i % 3));
  }
  KMeansState state;
  state.centroids.insert(state.centroids.end(), kDescriptorDimension, 11);
  state.centroids.insert(state.centroids.end(), kDescriptorDimension, 190);
  state.centroids.insert(state.centroids.end(), kDescriptorDimension, 190);  // a twin: ties go to the lower word
  state.centroids.insert(state.centroids.end(), kDescriptorDimension, 190);
  TrainerOptions options = small_training(4);
  std::vector<std::uint32_t> empty;
  for (int i = 0; i < 6; ++i) {
    state = *iterate_kmeans(DescriptorSpan(rows), state, options);
    empty.push_back(state.history.back().empty);
  }
  EXPECT_EQ(empty.front(), 2u);
  EXPECT_EQ(empty.back(), 0u);
  std::multiset<int> levels;
  for (std::size_t i = 0; i < 4; ++i) levels.insert(state.centroids[i * kDescriptorDimension]);
  EXPECT_EQ(levels, (std::multiset<int>{11, 81, 151, 221}));
}

TEST(Trainer, StopsWhenAskedAndForgetsTheIteration) {
  const Rows rows = test::clustered_descriptors(4000, 100, 60, 3);
  const TrainerOptions options = small_training(50);
  const KMeansState state = start_kmeans(DescriptorSpan(rows), options);
  int asked = 0;
  const auto stopped =
      iterate_kmeans(DescriptorSpan(rows), state, options, [&](std::uint64_t done, std::uint64_t total) {
        EXPECT_LT(done, total);
        return ++asked < 3;
      });
  EXPECT_FALSE(stopped.has_value());
  EXPECT_EQ(asked, 3);
}

TEST(Trainer, NeedsMoreDescriptorsThanWords) {
  const Rows rows = test::clustered_descriptors(10, 5, 5, 1);
  EXPECT_THROW(start_kmeans(DescriptorSpan(rows), small_training(11)), FormatError);
  EXPECT_THROW(start_kmeans(DescriptorSpan(rows), small_training(0)), FormatError);
  EXPECT_EQ(start_kmeans(DescriptorSpan(rows), small_training(10)).centroids.size(), rows.size());
}

TEST(SampleIndices, AreDistinctAscendingAndEven) {
  const auto sample = sample_indices(10'000, 1000, 7);
  ASSERT_EQ(sample.size(), 1000u);
  EXPECT_TRUE(std::adjacent_find(sample.begin(), sample.end(), std::greater_equal<>()) == sample.end());
  EXPECT_LT(sample.back(), 10'000u);
  const auto in_first_half = std::count_if(sample.begin(), sample.end(), [](std::uint64_t i) { return i < 5000; });
  EXPECT_NEAR(static_cast<double>(in_first_half), 500, 5 * std::sqrt(1000 * 0.25));
  EXPECT_EQ(sample_indices(10'000, 1000, 7), sample);
  EXPECT_NE(sample_indices(10'000, 1000, 8), sample);
  EXPECT_EQ(sample_indices(5, 9, 1), (std::vector<std::uint64_t>{0, 1, 2, 3, 4}));
}

TEST(OrderByLocality, KeepsEveryCentroidAndBringsNearOnesTogether) {
  const Rows rows = test::clustered_descriptors(1000, 1000, 0, 6);
  const Rows ordered = order_by_locality(rows);
  const auto as_set = [](const Rows& all) {
    std::multiset<std::string> set;
    for (std::size_t i = 0; i < all.size(); i += kDescriptorDimension) {
      set.emplace(reinterpret_cast<const char*>(all.data() + i), kDescriptorDimension);
    }
    return set;
  };
  EXPECT_EQ(as_set(ordered), as_set(rows));
  const auto step = [](const Rows& all) {
    std::int64_t sum = 0;
    for (std::size_t i = kDescriptorDimension; i < all.size(); i += kDescriptorDimension) {
      sum += test::squared_distance(all.data() + i - kDescriptorDimension, all.data() + i);
    }
    return sum;
  };
  EXPECT_LT(step(ordered), step(rows));
}

TEST(Evaluate, SetsAnIndexBesideExactSearch) {
  const Rows centroids = test::clustered_descriptors(500, 50, 60, 1);
  const Rows queries = test::clustered_descriptors(200, 50, 60, 2);
  WordIndexOptions exact;
  exact.engine = "exact";
  const auto index = build_word_index(centroids, exact);
  const Evaluation evaluation = evaluate(queries, centroids, *index);
  EXPECT_EQ(evaluation.descriptors, 200u);
  EXPECT_EQ(evaluation.recall, 1);
  std::int64_t distortion = 0;
  for (std::size_t i = 0; i < queries.size(); i += kDescriptorDimension) {
    const std::uint32_t nearest = test::nearest_row(queries.data() + i, centroids);
    distortion += test::squared_distance(queries.data() + i, centroids.data() + nearest * kDescriptorDimension);
  }
  EXPECT_DOUBLE_EQ(evaluation.mean_distortion, static_cast<double>(distortion) / 200);

  WordIndexOptions hasty;
  hasty.hnsw_search_effort = 1;
  hasty.hnsw_links = 2;
  EXPECT_LT(evaluate(queries, centroids, *build_word_index(centroids, hasty)).recall, 1);
}

}  // namespace
}  // namespace mapweld
