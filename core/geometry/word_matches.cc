#include "core/geometry/word_matches.h"

#include <cstddef>

namespace mapweld {
namespace {

// The appearances of one common word: [a_begin, a_end) of the first image, [b_begin, b_end) of the second.
struct CommonWord {
  std::uint32_t a_begin, a_end, b_begin, b_end;
  std::size_t pairings() const { return std::size_t{a_end - a_begin} * (b_end - b_begin); }
};

std::vector<CommonWord> common_words(const std::vector<Appearance>& a, const std::vector<Appearance>& b) {
  std::vector<CommonWord> common;
  const auto end_of_word = [](const std::vector<Appearance>& all, std::uint32_t i) {
    const WordId word = all[i].word;
    while (i < all.size() && all[i].word == word) ++i;
    return i;
  };
  std::uint32_t i = 0;
  std::uint32_t j = 0;
  while (i < a.size() && j < b.size()) {
    if (a[i].word < b[j].word) {
      ++i;
    } else if (b[j].word < a[i].word) {
      ++j;
    } else {
      common.push_back({i, end_of_word(a, i), j, end_of_word(b, j)});
      i = common.back().a_end;
      j = common.back().b_end;
    }
  }
  return common;
}

}  // namespace

std::vector<FeatureMatch> word_matches(const AppearanceVector& a, const AppearanceVector& b, int max_pairings,
                                       int max_matches) {
  const std::vector<CommonWord> common = common_words(a.appearances, b.appearances);
  // How many matches the words with 1, 2, ... pairings give; then the most pairings that still fit.
  std::vector<std::size_t> by_pairings(static_cast<std::size_t>(max_pairings) + 1, 0);
  for (const CommonWord& w : common) {
    if (w.pairings() < by_pairings.size()) by_pairings[w.pairings()] += w.pairings();
  }
  std::size_t total = 0;
  std::size_t allowed = 0;
  while (allowed + 1 < by_pairings.size() &&
         total + by_pairings[allowed + 1] <= static_cast<std::size_t>(max_matches)) {
    total += by_pairings[++allowed];
  }

  std::vector<FeatureMatch> matches;
  matches.reserve(total);
  for (const CommonWord& w : common) {
    if (w.pairings() > allowed) continue;
    for (std::uint32_t i = w.a_begin; i < w.a_end; ++i) {
      for (std::uint32_t j = w.b_begin; j < w.b_end; ++j) {
        matches.push_back({static_cast<std::uint16_t>(i), static_cast<std::uint16_t>(j)});
      }
    }
  }
  return matches;
}

}  // namespace mapweld
