#include "core/vocabulary/hierarchical_start.h"

#include <algorithm>
#include <cmath>

#include <flann/flann.hpp>

#include "core/types.h"

namespace mapweld {
namespace {

constexpr int kBranching = 32;
constexpr int kIterations = 11;

}  // namespace

std::vector<std::uint8_t> cluster_hierarchically(std::span<const std::uint8_t> rows, std::uint32_t clusters,
                                                 std::uint32_t seed) {
  using Distance = flann::L2<std::uint8_t>;
  // FLANN's matrix is never const; it reads only.
  const flann::Matrix<std::uint8_t> points(const_cast<std::uint8_t*>(rows.data()), rows.size() / kDescriptorDimension,
                                           kDescriptorDimension);
  std::vector<float> centres(std::size_t{clusters} * kDescriptorDimension);
  flann::Matrix<float> centre_rows(centres.data(), clusters, kDescriptorDimension);
  flann::seed_random(seed);
  const int found = flann::hierarchicalClustering<Distance>(
      points, centre_rows, flann::KMeansIndexParams(kBranching, kIterations, flann::FLANN_CENTERS_KMEANSPP));

  std::vector<std::uint8_t> bytes(static_cast<std::size_t>(found) * kDescriptorDimension);
  std::transform(centres.begin(), centres.begin() + static_cast<std::ptrdiff_t>(bytes.size()), bytes.begin(),
                 [](float value) { return static_cast<std::uint8_t>(std::clamp(std::lround(value), 0L, 255L)); });
  return bytes;
}

}  // namespace mapweld
