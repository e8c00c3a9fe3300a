#include "core/geometry/word_matches.h"

#include <algorithm>
#include <cstddef>

namespace mapweld {
namespace {

// Calls visit(begin_a, end_a, begin_b, end_b) for every common word, ascending.
template <typename Visit>
void for_common_words(const std::vector<Appearance>& a, const std::vector<Appearance>& b, Visit visit) {
  std::size_t i = 0;
  std::size_t j = 0;
  while (i < a.size() && j < b.size()) {
    if (a[i].word < b[j].word) {
      ++i;
    } else if (b[j].word < a[i].word) {
      ++j;
    } else {
      std::size_t i_end = i + 1;
      std::size_t j_end = j + 1;
      while (i_end < a.size() && a[i_end].word == a[i].word) ++i_end;
      while (j_end < b.size() && b[j_end].word == b[j].word) ++j_end;
      visit(i, i_end, j, j_end);
      i = i_end;
      j = j_end;
    }
  }
}

}  // namespace

std::vector<WordMatch> word_matches(const AppearanceVector& a, const AppearanceVector& b, int max_pairings,
                                    int max_matches) {
  // How many matches there are of words with 1, 2, ... pairings; then the most pairings that still fit.
  std::vector<std::size_t> by_pairings(static_cast<std::size_t>(max_pairings) + 1, 0);
  for_common_words(a.appearances, b.appearances,
                   [&](std::size_t i, std::size_t i_end, std::size_t j, std::size_t j_end) {
                     const std::size_t pairings = (i_end - i) * (j_end - j);
                     if (pairings < by_pairings.size()) by_pairings[pairings] += pairings;
                   });
  std::size_t total = 0;
  std::size_t allowed = 0;
  while (allowed + 1 < by_pairings.size() &&
         total + by_pairings[allowed + 1] <= static_cast<std::size_t>(max_matches)) {
    total += by_pairings[++allowed];
  }

  std::vector<WordMatch> matches;
  matches.reserve(total);
  for_common_words(a.appearances, b.appearances,
                   [&](std::size_t i, std::size_t i_end, std::size_t j, std::size_t j_end) {
                     if ((i_end - i) * (j_end - j) > allowed) return;
                     for (std::size_t p = i; p < i_end; ++p) {
                       for (std::size_t q = j; q < j_end; ++q) {
                         matches.push_back({static_cast<std::uint16_t>(p), static_cast<std::uint16_t>(q)});
                       }
                     }
                   });
  return matches;
}

}  // namespace mapweld
