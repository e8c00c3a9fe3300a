// Nearest neighbours among two images' SIFT descriptors: every distance of one list to the other, exactly.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace mapweld::evaluation {

// 128 bytes each, as SIFT gives them (whole numbers 0..255), laid out for products of whole blocks.
class DescriptorBlocks {
 public:
  explicit DescriptorBlocks(std::span<const std::uint8_t> descriptors);  // N x 128, row-major
  std::size_t size() const { return norms2_.size(); }

 private:
  friend class DescriptorProducts;
  std::vector<std::int16_t> rows_;    // N rounded up to a block x 128
  std::vector<std::int16_t> panels_;  // blocks of 16 columns: 64 pairs of components x 16 x 2
  std::vector<std::int32_t> norms2_;  // of each
};

// The nearest in the other list and the squared distances of it and of the second nearest.
struct NearestDescriptor {
  std::uint32_t index = 0;
  std::int32_t distance2 = kNoDistance2;
  std::int32_t runner_up2 = kNoDistance2;  // kNoDistance2: there was but one
  static constexpr std::int32_t kNoDistance2 = 1 << 30;
};

struct NearestDescriptors {
  std::vector<NearestDescriptor> of_a, of_b;
};

// O(a b): 2,000 by 2,000 take some 10 ms of one core with AVX2. `portable`: without it; the same result.
NearestDescriptors nearest_descriptors(const DescriptorBlocks& a, const DescriptorBlocks& b, bool portable = false);

}  // namespace mapweld::evaluation
