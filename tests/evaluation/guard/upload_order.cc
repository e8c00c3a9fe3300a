#include "tests/evaluation/guard/upload_order.h"

#include <algorithm>
#include <charconv>
#include <numeric>
#include <stdexcept>
#include <utility>

#include "core/random.h"

namespace mapweld::evaluation {
namespace {

constexpr const char* kShuffled = "shuffled:";

}  // namespace

UploadOrder upload_order_of(const std::string& text) {
  if (text == "given") return {};
  if (text == "reversed") return {.kind = UploadOrder::Kind::kReversed};
  UploadOrder order{.kind = UploadOrder::Kind::kShuffled};
  const std::string seed = text.starts_with(kShuffled) ? text.substr(std::string(kShuffled).size()) : "";
  const auto [end, error] = std::from_chars(seed.data(), seed.data() + seed.size(), order.seed);
  if (error != std::errc() || end != seed.data() + seed.size()) {
    throw std::invalid_argument("an order is given, reversed or shuffled:SEED, not \"" + text + "\"");
  }
  return order;
}

std::string upload_order_suffix(const UploadOrder& order) {
  switch (order.kind) {
    case UploadOrder::Kind::kReversed:
      return "-reversed";
    case UploadOrder::Kind::kShuffled:
      return "-shuffled-" + std::to_string(order.seed);
    case UploadOrder::Kind::kGiven:
      break;
  }
  return "";
}

std::vector<std::size_t> uploaded(const UploadOrder& order, std::size_t images, std::uint64_t map) {
  std::vector<std::size_t> sequence(images);
  std::iota(sequence.begin(), sequence.end(), std::size_t{0});
  if (order.kind == UploadOrder::Kind::kReversed) std::ranges::reverse(sequence);
  if (order.kind == UploadOrder::Kind::kShuffled) {
    SplitMix64 random(mix_bits(order.seed + kGoldenGamma) + map);
    for (std::size_t left = images; left > 1; --left) std::swap(sequence[left - 1], sequence[random.below(left)]);
  }
  return sequence;
}

}  // namespace mapweld::evaluation
