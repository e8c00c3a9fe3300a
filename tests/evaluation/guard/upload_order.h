// In which order photographs are uploaded: the order is the map.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace mapweld::evaluation {

struct UploadOrder {
  enum class Kind : std::uint8_t { kGiven, kReversed, kShuffled } kind = Kind::kGiven;
  std::uint64_t seed = 0;  // kShuffled
};

// "given", "reversed" or "shuffled:SEED". Throws std::invalid_argument for anything else.
UploadOrder upload_order_of(const std::string& text);

// What follows the name of a case that is uploaded so: nothing for the order given.
std::string upload_order_suffix(const UploadOrder& order);

// Which of the `images` photographs of map number `map` is uploaded first, second and so on. Two maps of one size are
// shuffled differently.
std::vector<std::size_t> uploaded(const UploadOrder& order, std::size_t images, std::uint64_t map);

}  // namespace mapweld::evaluation
