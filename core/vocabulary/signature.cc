#include "core/vocabulary/signature.h"

#include <cstddef>

namespace mapweld {
namespace {

constexpr std::size_t kHalf = kDescriptorDimension / 2;

// By bisection over the 256 values: counting is one pass that the compiler vectorises.
std::uint8_t upper_median(std::span<const std::uint8_t, kDescriptorDimension> descriptor) {
  unsigned median = 0;  // the greatest value that at most 64 components are less than
  for (unsigned bit = 128; bit > 0; bit /= 2) {
    const auto tried = static_cast<std::uint8_t>(median + bit);
    std::uint8_t less = 0;
    for (const std::uint8_t component : descriptor) less += component < tried ? 1 : 0;
    if (less <= kHalf) median = tried;
  }
  return static_cast<std::uint8_t>(median);
}

}  // namespace

Signature signature_of(std::span<const std::uint8_t, kDescriptorDimension> descriptor) {
  const std::uint8_t median = upper_median(descriptor);
  Signature signature;
  for (std::size_t i = 0; i < descriptor.size(); ++i) {
    signature.bits[i / 32] |= std::uint32_t{descriptor[i] > median} << i % 32;
  }
  if (signature == Signature{}) signature.bits[0] = 1;
  return signature;
}

}  // namespace mapweld
