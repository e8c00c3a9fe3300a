#include "core/vocabulary/trainer.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <numeric>
#include <thread>

#include "core/errors.h"
#include "core/random.h"
#include "core/vocabulary/distance.h"
#include "core/vocabulary/hierarchical_start.h"

namespace mapweld {
namespace {

constexpr std::size_t kBytes = kDescriptorDimension;

// Calls work(part, parts) on `parts` threads and waits.
template <typename Work>
void in_parallel(int parts, const Work& work) {
  std::vector<std::jthread> threads;
  for (int part = 1; part < parts; ++part) threads.emplace_back([&work, part, parts] { work(part, parts); });
  work(0, parts);
}

std::pair<std::size_t, std::size_t> share(std::size_t size, int part, int parts) {
  const auto at = [&](int i) { return size * static_cast<std::size_t>(i) / static_cast<std::size_t>(parts); };
  return {at(part), at(part + 1)};
}

// What an iteration sums up, by cluster. Clusters are shared out among threads, and each thread sees the descriptors in
// their order: the result does not know how many threads there were.
class Clusters {
 public:
  explicit Clusters(std::size_t words)
      : sums_(words * kBytes), population_(words), distortion_(words), farthest_distance_(words), farthest_(words) {}

  // Adds those of a block's descriptors whose word lies in [first, last).
  void add(std::span<const std::uint8_t> rows, std::span<const WordId> words, std::span<const std::uint8_t> centroids,
           std::uint64_t first_index, std::size_t first, std::size_t last) {
    const DistanceKernel& kernel = distance_kernel();
    for (std::size_t i = 0; i < words.size(); ++i) {
      const std::size_t word = to_index(words[i]);
      if (word < first || word >= last) continue;
      const std::uint8_t* row = rows.data() + i * kBytes;
      std::uint64_t* sum = sums_.data() + word * kBytes;
      for (std::size_t k = 0; k < kBytes; ++k) sum[k] += row[k];
      const SquaredDistance distance = kernel.pair(row, centroids.data() + word * kBytes);
      distortion_[word] += distance;
      if (population_[word]++ == 0 || distance > farthest_distance_[word]) {
        farthest_distance_[word] = distance;
        farthest_[word] = first_index + i;
      }
    }
  }

  KMeansState move(const KMeansState& state, const DescriptorSource& source) const {
    KMeansState next = state;
    IterationReport report;
    report.distortion = std::accumulate(distortion_.begin(), distortion_.end(), std::uint64_t{0});
    std::vector<std::size_t> empty;
    for (std::size_t word = 0; word < population_.size(); ++word) {
      const std::uint64_t count = population_[word];
      if (count == 0) {
        empty.push_back(word);
        continue;
      }
      for (std::size_t k = word * kBytes; k < (word + 1) * kBytes; ++k) {
        next.centroids[k] = static_cast<std::uint8_t>((sums_[k] + count / 2) / count);
        report.moved += next.centroids[k] != state.centroids[k];
      }
    }
    report.empty = static_cast<std::uint32_t>(empty.size());
    seed_anew(empty, source, next.centroids);
    next.history.push_back(report);
    return next;
  }

 private:
  void seed_anew(const std::vector<std::size_t>& empty, const DescriptorSource& source,
                 std::vector<std::uint8_t>& centroids) const {
    std::vector<std::size_t> worst(population_.size());
    std::iota(worst.begin(), worst.end(), std::size_t{0});
    std::stable_sort(worst.begin(), worst.end(),
                     [&](std::size_t a, std::size_t b) { return distortion_[a] > distortion_[b]; });
    for (std::size_t i = 0; i < empty.size() && distortion_[worst[i]] > 0; ++i) {
      source.read(farthest_[worst[i]], std::span(centroids).subspan(empty[i] * kBytes, kBytes));
    }
  }

  std::vector<std::uint64_t> sums_;
  std::vector<std::uint64_t> population_;
  std::vector<std::uint64_t> distortion_;
  std::vector<SquaredDistance> farthest_distance_;
  std::vector<std::uint64_t> farthest_;  // index of the descriptor farthest from its centroid
};

}  // namespace

void DescriptorSpan::read(std::uint64_t first, std::span<std::uint8_t> rows) const {
  const auto from = rows_.subspan(first * kBytes, rows.size());
  std::copy(from.begin(), from.end(), rows.begin());
}

std::vector<std::uint64_t> sample_indices(std::uint64_t size, std::uint64_t count, std::uint32_t seed) {
  // Knuth's selection sampling: each index is kept with the chance that fills the sample exactly.
  std::vector<std::uint64_t> sample;
  sample.reserve(std::min(size, count));
  SplitMix64 random(seed);
  for (std::uint64_t i = 0; i < size && sample.size() < count; ++i) {
    if (random.below(size - i) < count - sample.size()) sample.push_back(i);
  }
  return sample;
}

KMeansState start_kmeans(const DescriptorSource& source, const TrainerOptions& options) {
  if (options.words == 0) throw FormatError("a vocabulary needs at least one word");
  if (source.size() < options.words) {
    throw FormatError("there are " + std::to_string(source.size()) + " descriptors for " +
                      std::to_string(options.words) + " words; more images or fewer words are needed");
  }
  const auto sample =
      sample_indices(source.size(), std::max<std::uint64_t>(options.start_sample, options.words), options.seed);
  std::vector<std::uint8_t> rows(sample.size() * kBytes);
  for (std::size_t i = 0; i < sample.size();) {
    std::size_t end = i + 1;
    while (end < sample.size() && sample[end] == sample[end - 1] + 1) ++end;
    source.read(sample[i], std::span(rows).subspan(i * kBytes, (end - i) * kBytes));
    i = end;
  }

  KMeansState state;
  state.centroids = cluster_hierarchically(rows, options.words, options.seed);
  const std::size_t missing = options.words - state.centroids.size() / kBytes;
  for (const std::uint64_t i : sample_indices(sample.size(), missing, options.seed + 1)) {
    state.centroids.insert(state.centroids.end(), rows.begin() + static_cast<std::ptrdiff_t>(i * kBytes),
                           rows.begin() + static_cast<std::ptrdiff_t>((i + 1) * kBytes));
  }
  return state;
}

std::optional<KMeansState> iterate_kmeans(const DescriptorSource& source, const KMeansState& state,
                                          const TrainerOptions& options, const TrainingProgress& progress) {
  const std::size_t words = state.centroids.size() / kBytes;
  const int threads = std::max(1, options.threads);
  const auto index = build_word_index(state.centroids, options.index);
  Clusters clusters(words);
  std::vector<std::uint8_t> rows;
  std::vector<WordId> assigned;
  for (std::uint64_t first = 0; first < source.size();) {
    if (progress && !progress(first, source.size())) return std::nullopt;
    const auto count = static_cast<std::size_t>(std::min(options.block, source.size() - first));
    rows.resize(count * kBytes);
    assigned.resize(count);
    source.read(first, rows);
    in_parallel(threads, [&](int part, int parts) {
      const auto [begin, end] = share(count, part, parts);
      index->quantise(std::span(rows).subspan(begin * kBytes, (end - begin) * kBytes),
                      std::span(assigned).subspan(begin, end - begin));
    });
    in_parallel(threads, [&](int part, int parts) {
      const auto [begin, end] = share(words, part, parts);
      clusters.add(rows, assigned, state.centroids, first, begin, end);
    });
    first += count;
  }
  return clusters.move(state, source);
}

std::vector<std::uint8_t> order_by_locality(std::span<const std::uint8_t> centroids) {
  constexpr std::size_t kLeaf = 2;
  std::vector<std::uint32_t> order(centroids.size() / kBytes);
  std::iota(order.begin(), order.end(), 0u);
  std::vector<std::pair<std::size_t, std::size_t>> open{{0, order.size()}};
  while (!open.empty()) {
    const auto [first, last] = open.back();
    open.pop_back();
    if (last - first <= kLeaf) continue;
    std::array<std::uint64_t, kBytes> sum{};
    std::array<std::uint64_t, kBytes> squares{};
    for (std::size_t i = first; i < last; ++i) {
      const std::uint8_t* row = centroids.data() + order[i] * kBytes;
      for (std::size_t k = 0; k < kBytes; ++k) {
        sum[k] += row[k];
        squares[k] += std::uint64_t{row[k]} * row[k];
      }
    }
    std::size_t widest = 0;
    std::uint64_t most = 0;
    for (std::size_t k = 0; k < kBytes; ++k) {
      const std::uint64_t spread = squares[k] * (last - first) - sum[k] * sum[k];
      if (spread > most) {
        most = spread;
        widest = k;
      }
    }
    const std::size_t middle = first + (last - first) / 2;
    std::sort(order.begin() + static_cast<std::ptrdiff_t>(first), order.begin() + static_cast<std::ptrdiff_t>(last),
              [&](std::uint32_t a, std::uint32_t b) {
                return std::pair(centroids[a * kBytes + widest], a) < std::pair(centroids[b * kBytes + widest], b);
              });
    open.emplace_back(first, middle);
    open.emplace_back(middle, last);
  }

  std::vector<std::uint8_t> ordered(centroids.size());
  for (std::size_t i = 0; i < order.size(); ++i) {
    std::memcpy(ordered.data() + i * kBytes, centroids.data() + order[i] * kBytes, kBytes);
  }
  return ordered;
}

Evaluation evaluate(std::span<const std::uint8_t> descriptors, std::span<const std::uint8_t> centroids,
                    const WordIndex& index) {
  Evaluation evaluation;
  evaluation.descriptors = descriptors.size() / kBytes;
  if (evaluation.descriptors == 0) return evaluation;
  std::vector<WordId> found(evaluation.descriptors);
  std::vector<WordId> nearest(evaluation.descriptors);
  index.quantise(descriptors, found);
  WordIndexOptions exact;
  exact.engine = "exact";
  build_word_index(centroids, exact)->quantise(descriptors, nearest);

  const DistanceKernel& kernel = distance_kernel();
  const auto distance = [&](std::size_t i, WordId word) {
    return kernel.pair(descriptors.data() + i * kBytes, centroids.data() + std::size_t{to_index(word)} * kBytes);
  };
  std::uint64_t right = 0;
  std::uint64_t distortion = 0;
  for (std::size_t i = 0; i < found.size(); ++i) {
    right += found[i] == nearest[i];
    distortion += distance(i, found[i]);
  }
  const auto count = static_cast<double>(evaluation.descriptors);
  evaluation.recall = static_cast<double>(right) / count;
  evaluation.mean_distortion = static_cast<double>(distortion) / count;
  return evaluation;
}

}  // namespace mapweld
