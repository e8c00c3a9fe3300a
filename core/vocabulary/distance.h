// Squared Euclidean distance of byte descriptors: whole numbers, so every processor finds the same nearest word.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "core/types.h"

namespace mapweld {

// Largest possible squared distance: 128 * 255^2 < 2^23.
using SquaredDistance = std::uint32_t;

// The widest instruction set a kernel uses; all give the same integers.
enum class Simd : std::uint8_t { kScalar, kAvx2, kAvx512Vnni };

// Of one query to many rows of one table.
struct DistanceKernel {
  // out[i] = squared distance of `query` (128 bytes) to row `rows[i]` of `table` (rows x 128 bytes).
  void (*gather)(const std::uint8_t* query, const std::uint8_t* table, const std::uint32_t* rows, std::size_t count,
                 SquaredDistance* out);
  // Squared distance of two descriptors.
  SquaredDistance (*pair)(const std::uint8_t* a, const std::uint8_t* b);
  Simd simd;
};

// The best kernel of this processor, or at most `limit` (tests set the kernels side by side).
const DistanceKernel& distance_kernel(Simd limit = Simd::kAvx512Vnni);

}  // namespace mapweld
