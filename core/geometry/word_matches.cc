#include "core/geometry/word_matches.h"

#include <algorithm>

namespace mapweld {

ImageWords words_of(const AppearanceVector& image) {
  ImageWords of;
  const std::vector<Appearance>& all = image.appearances;
  of.words.reserve(all.size());
  of.starts.reserve(all.size() + 1);
  for (std::uint32_t i = 0; i < all.size(); ++i) {
    if (i > 0 && all[i].word == all[i - 1].word) continue;
    of.words.push_back(all[i].word);
    of.starts.push_back(i);
  }
  of.starts.push_back(static_cast<std::uint32_t>(all.size()));
  return of;
}

std::vector<CommonWord> common_words(const ImageWords& a, const ImageWords& b) {
  // Which of two words is the lesser nobody can foresee: no branch depends on it.
  const std::size_t most = std::min(a.words.size(), b.words.size());
  std::vector<std::pair<std::uint32_t, std::uint32_t>> both(most + 1);
  std::size_t found = 0;
  for (std::uint32_t i = 0, j = 0; i < a.words.size() && j < b.words.size();) {
    const WordId of_a = a.words[i], of_b = b.words[j];
    both[found] = {i, j};
    found += of_a == of_b ? 1 : 0;
    i += of_a <= of_b ? 1 : 0;
    j += of_b <= of_a ? 1 : 0;
  }
  std::vector<CommonWord> common;
  common.reserve(found);
  for (std::size_t k = 0; k < found; ++k) {
    const auto [i, j] = both[k];
    common.push_back({a.starts[i], a.starts[i + 1], b.starts[j], b.starts[j + 1]});
  }
  return common;
}

std::vector<FeatureMatch> word_matches(std::span<const CommonWord> common, int max_pairings, int max_matches) {
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

std::vector<FeatureMatch> word_matches(const AppearanceVector& a, const AppearanceVector& b, int max_pairings,
                                       int max_matches) {
  return word_matches(common_words(words_of(a), words_of(b)), max_pairings, max_matches);
}

}  // namespace mapweld
