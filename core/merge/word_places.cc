#include "core/merge/word_places.h"

#include <algorithm>

namespace mapweld {

WordPlaces::WordPlaces(const AppearanceSource& appearances, const std::vector<MergeMember>& members) {
  // Appearances are sorted by word: a word that comes again in one image stands beside itself.
  const auto for_each_word = [](const AppearanceVector& image, const auto& use) {
    for (std::size_t i = 0; i < image.appearances.size(); ++i) {
      const WordId word = image.appearances[i].word;
      if (i == 0 || image.appearances[i - 1].word != word) use(to_index(word));
    }
  };
  std::vector<std::pair<std::uint32_t, std::shared_ptr<const AppearanceVector>>> images;
  offsets_.assign(1, 0);
  for (const MergeMember& member : members) {
    for (const VertexId v : member.vertices) {
      images.emplace_back(to_index(v), appearances.appearances(v));
      for_each_word(*images.back().second, [&](std::uint32_t word) {
        if (word + 2 > offsets_.size()) offsets_.resize(word + 2, 0);
        ++offsets_[word + 1];
      });
    }
  }
  for (std::size_t w = 1; w < offsets_.size(); ++w) offsets_[w] += offsets_[w - 1];
  vertices_.resize(offsets_.back());
  std::vector<std::uint32_t> next(offsets_.begin(), offsets_.end() - 1);
  for (const auto& [vertex, image] : images) {
    for_each_word(*image, [&, v = vertex](std::uint32_t word) { vertices_[next[word]++] = v; });
  }
}

std::span<const std::uint32_t> WordPlaces::vertices_with(WordId word) const {
  const std::uint32_t w = to_index(word);
  if (w + 1 >= offsets_.size()) return {};
  return std::span(vertices_).subspan(offsets_[w], offsets_[w + 1] - offsets_[w]);
}

}  // namespace mapweld
