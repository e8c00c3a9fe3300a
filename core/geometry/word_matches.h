// Matches between two images: features that were given the same visual word.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/geometry/feature_match.h"
#include "core/types.h"

namespace mapweld {

// The words of an image, each once: that at k is of the appearances starts[k] .. starts[k + 1] - 1.
struct ImageWords {
  std::vector<WordId> words;          // ascending
  std::vector<std::uint32_t> starts;  // one more than words
};
ImageWords words_of(const AppearanceVector& image);

// The appearances of a word that both images have: [a_begin, a_end) of the first, [b_begin, b_end) of the second.
struct CommonWord {
  std::uint32_t a_begin, a_end, b_begin, b_end;
  std::size_t pairings() const { return std::size_t{a_end - a_begin} * (b_end - b_begin); }
};
// Ascending by word.
std::vector<CommonWord> common_words(const ImageWords& a, const ImageWords& b);

// All pairings of equal words, ascending by (a, b), of the words with at most `max_pairings` of them; a word that
// appears too often (a texture) says nothing about which of its features belong together. With more than
// `max_matches` pairings in all, the words with the most pairings are left out until the rest fits.
// Images have at most 65536 appearances, sorted by word.
std::vector<FeatureMatch> word_matches(std::span<const CommonWord> common, int max_pairings, int max_matches);
std::vector<FeatureMatch> word_matches(const AppearanceVector& a, const AppearanceVector& b, int max_pairings,
                                       int max_matches);

}  // namespace mapweld
