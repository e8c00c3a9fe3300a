// The engines that find a descriptor's word, side by side on the shipped vocabulary: time for 500 descriptors (one
// image) on one core, and recall, the share of descriptors that get their exact nearest word.
//
//   word_index_benchmark          the table of docs/vocabulary.md, "Engines"
//
// Descriptors are those of the test photographs, which the vocabulary was not trained on.
#include <cstdlib>
#include <map>
#include <memory>

#include <Eigen/Core>
#include <benchmark/benchmark.h>
#include <flann/flann.hpp>

// hnswlib's own SIMD defines functions in the header and speaks of floats only.
#define NO_MANUAL_VECTORIZATION
#include <hnswlib/hnswlib.h>

#include "core/vocabulary/distance.h"
#include "core/vocabulary/hnsw_graph.h"
#include "core/vocabulary/hnsw_index.h"
#include "core/vocabulary/vocabulary.h"
#include "tests/benchmark/photograph_descriptors.h"

namespace mapweld {
namespace {

using Rows = std::vector<std::uint8_t>;
using FloatRows = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

constexpr std::size_t kPerImage = 500;

struct Setting {
  std::shared_ptr<const Vocabulary> vocabulary = Vocabulary::deserialize(test::shipped_vocabulary_file());
  Rows queries = test::photograph_descriptors(6, 20'000);
  std::vector<WordId> exact;
  HnswGraph graph;

  Setting() {
    exact.resize(queries.size() / kDescriptorDimension);
    WordIndexOptions options;
    options.engine = "exact";
    build_word_index(vocabulary->centroids(), options)->quantise(queries, exact);
    graph = build_hnsw_graph(vocabulary->centroids(), {});
  }
};

const Setting& setting() {
  static const Setting made;
  return made;
}

// Runs `quantise(first, count, words)` image by image and reports its recall.
template <typename Quantise>
void measure(benchmark::State& state, const Quantise& quantise) {
  const std::size_t images = setting().exact.size() / kPerImage;
  if (images == 0) {
    state.SkipWithError("the test photographs are not here (MAPWELD_PHOTOS)");
    return;
  }
  std::vector<WordId> words(images * kPerImage);
  std::size_t image = 0;
  for (auto _ : state) {
    quantise(image * kPerImage, kPerImage, words.data() + image * kPerImage);
    image = (image + 1) % images;
  }
  std::size_t right = 0;
  for (image = 0; image < images; ++image) quantise(image * kPerImage, kPerImage, words.data() + image * kPerImage);
  for (std::size_t i = 0; i < words.size(); ++i) right += words[i] == setting().exact[i];
  state.counters["recall"] = static_cast<double>(right) / static_cast<double>(words.size());
}

void measure_index(benchmark::State& state, const WordIndex& index) {
  measure(state, [&](std::size_t first, std::size_t count, WordId* words) {
    index.quantise(std::span(setting().queries).subspan(first * kDescriptorDimension, count * kDescriptorDimension),
                   {words, count});
  });
}

void hnsw(benchmark::State& state) {
  const HnswIndex index(setting().vocabulary->centroids(), setting().graph, static_cast<int>(state.range(0)));
  measure_index(state, index);
}

// The same links, searched by hnswlib, with the fastest distance of this processor.
class ByteSpace final : public hnswlib::SpaceInterface<int> {
 public:
  std::size_t get_data_size() override { return kDescriptorDimension; }
  hnswlib::DISTFUNC<int> get_dist_func() override {
    return [](const void* a, const void* b, const void*) {
      return static_cast<int>(
          distance_kernel().pair(static_cast<const std::uint8_t*>(a), static_cast<const std::uint8_t*>(b)));
    };
  }
  void* get_dist_func_param() override { return nullptr; }
};

void hnswlib_search(benchmark::State& state) {
  static ByteSpace space;
  static const auto index = [] {
    auto made = std::make_unique<hnswlib::HierarchicalNSW<int>>(&space, setting().vocabulary->words(), 16, 200, 1);
    for (std::size_t word = 0; word < setting().vocabulary->words(); ++word) {
      made->addPoint(setting().vocabulary->centroids().data() + word * kDescriptorDimension, word);
    }
    return made;
  }();
  index->setEf(static_cast<std::size_t>(state.range(0)));
  measure(state, [&](std::size_t first, std::size_t count, WordId* words) {
    for (std::size_t i = 0; i < count; ++i) {
      const auto found = index->searchKnn(setting().queries.data() + (first + i) * kDescriptorDimension, 1);
      words[i] = WordId{static_cast<std::uint32_t>(found.top().second)};
    }
  });
}

FloatRows as_floats(std::span<const std::uint8_t> rows) {
  return Eigen::Map<const Eigen::Matrix<std::uint8_t, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>>(
             rows.data(), static_cast<Eigen::Index>(rows.size() / kDescriptorDimension), kDescriptorDimension)
      .cast<float>();
}

template <typename Index>
void measure_flann(benchmark::State& state, const flann::IndexParams& params) {
  static FloatRows centroids = as_floats(setting().vocabulary->centroids());
  static std::map<std::string, std::unique_ptr<Index>> built;
  auto& index = built[typeid(Index).name()];
  if (!index) {
    index = std::make_unique<Index>(
        flann::Matrix<float>(centroids.data(), static_cast<std::size_t>(centroids.rows()), kDescriptorDimension),
        params);
    index->buildIndex();
  }
  FloatRows queries = as_floats(setting().queries);
  flann::SearchParams search(static_cast<int>(state.range(0)));
  search.cores = 1;
  measure(state, [&](std::size_t first, std::size_t count, WordId* words) {
    std::vector<int> found(count);
    std::vector<float> distances(count);
    flann::Matrix<int> found_rows(found.data(), count, 1);
    flann::Matrix<float> distance_rows(distances.data(), count, 1);
    index->knnSearch(
        flann::Matrix<float>(queries.row(static_cast<Eigen::Index>(first)).data(), count, kDescriptorDimension),
        found_rows, distance_rows, 1, search);
    for (std::size_t i = 0; i < count; ++i) words[i] = WordId{static_cast<std::uint32_t>(found[i])};
  });
}

void flann_kd_forest(benchmark::State& state) {
  measure_flann<flann::KDTreeIndex<flann::L2<float>>>(state, flann::KDTreeIndexParams(4));
}

void flann_k_means_tree(benchmark::State& state) {
  measure_flann<flann::KMeansIndex<flann::L2<float>>>(state,
                                                      flann::KMeansIndexParams(32, 11, flann::FLANN_CENTERS_KMEANSPP));
}

// Exact: |c|^2 - 2 q.c by a matrix product of real numbers.
void exact_sgemm(benchmark::State& state) {
  const FloatRows centroids = as_floats(setting().vocabulary->centroids());
  const FloatRows queries = as_floats(setting().queries);
  const Eigen::VectorXf squares = centroids.rowwise().squaredNorm();
  constexpr Eigen::Index kBlock = 1024;
  measure(state, [&](std::size_t first, std::size_t count, WordId* words) {
    const auto block = queries.middleRows(static_cast<Eigen::Index>(first), static_cast<Eigen::Index>(count));
    std::vector<float> best(count, std::numeric_limits<float>::max());
    for (Eigen::Index row = 0; row < centroids.rows(); row += kBlock) {
      const Eigen::Index rows = std::min(kBlock, centroids.rows() - row);
      const FloatRows products = block * centroids.middleRows(row, rows).transpose();
      for (std::size_t i = 0; i < count; ++i) {
        Eigen::Index nearest = 0;
        const float distance = (squares.segment(row, rows).transpose() - 2 * products.row(static_cast<Eigen::Index>(i)))
                                   .minCoeff(&nearest);
        if (distance >= best[i]) continue;
        best[i] = distance;
        words[i] = WordId{static_cast<std::uint32_t>(row + nearest)};
      }
    }
  });
}

void exact_bytes(benchmark::State& state) {
  WordIndexOptions options;
  options.engine = "exact";
  measure_index(state, *build_word_index(setting().vocabulary->centroids(), options));
}

BENCHMARK(hnsw)->Arg(12)->Arg(16)->Arg(24)->Arg(32)->Arg(48)->Arg(64)->Unit(benchmark::kMillisecond);
BENCHMARK(hnswlib_search)->Arg(16)->Arg(24)->Arg(32)->Arg(48)->Unit(benchmark::kMillisecond);
BENCHMARK(flann_kd_forest)->Arg(32)->Arg(256)->Arg(1024)->Arg(4096)->Unit(benchmark::kMillisecond);
BENCHMARK(flann_k_means_tree)->Arg(32)->Arg(256)->Arg(1024)->Arg(2048)->Unit(benchmark::kMillisecond);
BENCHMARK(exact_sgemm)->Unit(benchmark::kMillisecond);
BENCHMARK(exact_bytes)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace mapweld
