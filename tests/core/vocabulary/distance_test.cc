#include "core/vocabulary/distance.h"

#include <numeric>

#include <gtest/gtest.h>

#include "tests/core/vocabulary/descriptor_sets.h"

namespace mapweld {
namespace {

// On a processor without AVX2 or VNNI the limit gives a lesser kernel, which is then tested twice.
class DistanceKernels : public testing::TestWithParam<Simd> {};

TEST_P(DistanceKernels, GiveTheSquaredDistance) {
  const DistanceKernel& kernel = distance_kernel(GetParam());
  EXPECT_LE(kernel.simd, GetParam());
  SplitMix64 random(3);
  std::vector<std::uint8_t> table(200 * kDescriptorDimension);
  for (auto& byte : table) byte = static_cast<std::uint8_t>(random.below(256));
  // The extremes: everything 0, everything 255.
  std::fill_n(table.begin(), kDescriptorDimension, std::uint8_t{0});
  std::fill_n(table.begin() + kDescriptorDimension, kDescriptorDimension, std::uint8_t{255});

  std::vector<std::uint32_t> rows(200);
  std::iota(rows.rbegin(), rows.rend(), 0u);
  std::vector<SquaredDistance> distances(rows.size());
  for (std::size_t query = 0; query < 200; ++query) {
    const std::uint8_t* a = table.data() + query * kDescriptorDimension;
    kernel.gather(a, table.data(), rows.data(), rows.size(), distances.data());
    for (std::size_t i = 0; i < rows.size(); ++i) {
      const std::uint8_t* b = table.data() + rows[i] * kDescriptorDimension;
      ASSERT_EQ(distances[i], test::squared_distance(a, b));
      ASSERT_EQ(kernel.pair(a, b), test::squared_distance(a, b));
    }
  }
}

INSTANTIATE_TEST_SUITE_P(, DistanceKernels, testing::Values(Simd::kScalar, Simd::kAvx2, Simd::kAvx512Vnni));

}  // namespace
}  // namespace mapweld
