// Lists come in pages.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "client/contract/codec.h"

namespace mapweld::contract {

inline constexpr int kMaxPageItems = 1000;     // the most that ?limit= may ask for
inline constexpr int kDefaultPageItems = 100;  // without ?limit=

// `next_cursor` goes into ?cursor= for the page that follows; null on the last one.
template <class T>
struct Page {
  std::vector<T> items;
  std::optional<std::string> next_cursor;
  static constexpr auto fields() {
    return std::tuple(field("items", &Page::items), field("next_cursor", &Page::next_cursor));
  }
};

}  // namespace mapweld::contract
