// Logarithms, rotations and hashes that give the same bits on every processor. The C library picks its implementation
// by what the processor can do, and may differ in the last bit; these use only the exactly rounded operations of
// IEEE 754 (+ - * / sqrt).
#pragma once

#include <cstdint>

#include "core/types.h"

namespace mapweld {

// Natural, binary and decimal logarithm of x > 0, relative error below 1e-14.
double portable_log(double x);
double portable_log2(double x);
double portable_log10(double x);

// Decimal logarithm of the binomial coefficient n over k, 0 <= k <= n <= 65535.
double log10_binomial(int n, int k);

struct Rotation {
  double cos = 1;
  double sin = 0;
};
// Rotation by an angle in [0, 360] degrees, error below 1e-14.
Rotation portable_rotation(double angle_deg);

// A 64-bit hash of what an image shows: its size and appearances, nothing else.
std::uint64_t content_hash(const AppearanceVector& image);

}  // namespace mapweld
