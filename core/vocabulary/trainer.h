// Training of a vocabulary (paper, section III): k-means over millions of SIFT descriptors, which need not fit in
// memory.
//
// A start by hierarchical clustering of a sample (FLANN), then Lloyd iterations over everything, each descriptor
// assigned to its nearest centroid approximately, by the same index that quantises later. Sums are whole numbers, so
// neither the number of threads nor an interruption between two iterations changes a bit of the result.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "core/vocabulary/word_index.h"

namespace mapweld {

// Descriptors in a fixed order: a file, or memory.
class DescriptorSource {
 public:
  virtual ~DescriptorSource() = default;
  virtual std::uint64_t size() const = 0;
  // Copies descriptors first, first+1, ... into `rows` (count x 128 bytes). One thread at a time. Throws on I/O errors.
  virtual void read(std::uint64_t first, std::span<std::uint8_t> rows) const = 0;
};

// A source in memory; refers to `rows` (N x 128 bytes).
class DescriptorSpan final : public DescriptorSource {
 public:
  explicit DescriptorSpan(std::span<const std::uint8_t> rows) : rows_(rows) {}
  std::uint64_t size() const override { return rows_.size() / kDescriptorDimension; }
  void read(std::uint64_t first, std::span<std::uint8_t> rows) const override;

 private:
  std::span<const std::uint8_t> rows_;
};

struct TrainerOptions {
  std::uint32_t words = 50'000;
  std::uint64_t start_sample = 1'000'000;  // descriptors that the hierarchical start sees
  std::uint64_t block = 65'536;            // descriptors in memory at once
  int threads = 1;                         // changes the time, never the result
  std::uint32_t seed = 1;
  WordIndexOptions index;  // assigns, and is rebuilt for every iteration
};

// What one Lloyd iteration found with the centroids it was given.
struct IterationReport {
  std::uint64_t distortion = 0;  // sum of squared distances to the assigned centroids
  std::uint64_t moved = 0;       // components of centroids that changed
  std::uint32_t empty = 0;       // centroids without a descriptor, seeded anew
  friend bool operator==(const IterationReport&, const IterationReport&) = default;
};

// Everything k-means remembers between iterations.
struct KMeansState {
  std::vector<std::uint8_t> centroids;   // words x 128 bytes
  std::vector<IterationReport> history;  // one an iteration
  friend bool operator==(const KMeansState&, const KMeansState&) = default;
};

// Called now and then with the share of work done; false asks to stop.
using TrainingProgress = std::function<bool(std::uint64_t done, std::uint64_t total)>;

// `count` distinct indices below `size`, ascending; all of them when there are no more. Seeded.
std::vector<std::uint64_t> sample_indices(std::uint64_t size, std::uint64_t count, std::uint32_t seed);

// The hierarchical start. Fewer distinct descriptors than words are filled up with copies, which the iterations leave
// empty. Draws from std::rand, seeded: nothing else in the process may draw meanwhile. Throws FormatError when the
// source has fewer descriptors than words.
KMeansState start_kmeans(const DescriptorSource& source, const TrainerOptions& options);

// One Lloyd iteration: assigns every descriptor, moves every centroid to the rounded mean of its descriptors, and moves
// empty ones to where clusters are worst: the j-th empty centroid (by number) goes to the descriptor farthest from
// its centroid in the cluster of the j-th greatest distortion. nullopt when `progress` asked to stop.
std::optional<KMeansState> iterate_kmeans(const DescriptorSource& source, const KMeansState& state,
                                          const TrainerOptions& options, const TrainingProgress& progress = {});

// The same centroids in an order in which near numbers are near words, so that files compress and caches hit: halved
// at the median of the component that varies most, again and again.
std::vector<std::uint8_t> order_by_locality(std::span<const std::uint8_t> centroids);

struct Evaluation {
  std::uint64_t descriptors = 0;
  double recall = 0;           // share for which the index found an exact nearest word
  double mean_distortion = 0;  // squared distance to the word found, a descriptor
};

// Sets the index beside exact search.
Evaluation evaluate(std::span<const std::uint8_t> descriptors, std::span<const std::uint8_t> centroids,
                    const WordIndex& index);

}  // namespace mapweld
