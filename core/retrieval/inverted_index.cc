#include "core/retrieval/inverted_index.h"

#include <algorithm>
#include <functional>
#include <stdexcept>

#include "core/errors.h"
#include "core/retrieval/voting.h"

namespace mapweld {

std::vector<Posting>& InvertedIndex::at(WordId word) {
  const std::size_t i = to_index(word);
  if (i >= by_word_.size()) by_word_.resize(i + 1);
  return by_word_[i];
}

void InvertedIndex::add(const AppearanceVector& image) {
  if (!std::ranges::is_sorted(image.appearances, {}, &Appearance::word)) {
    throw std::invalid_argument("appearances are not sorted by word");
  }
  const VertexId vertex{vertices_};
  for (const WordCount& w : count_words(image)) at(w.word).push_back({vertex, w.count});
  ++vertices_;
}

void InvertedIndex::add_segment(std::uint32_t first, std::uint32_t count, std::span<const WordId> words,
                                std::span<const std::uint32_t> offsets, std::span<const Posting> postings) {
  const auto require = [](bool holds, const char* what) {
    if (!holds) throw FormatError(what);
  };
  require(first == vertices_ && count <= UINT32_MAX - first, "segment does not follow the index");
  require(offsets.size() == words.size() + 1, "segment has not one offset a word and one at the end");
  require(offsets.front() == 0 && offsets.back() == postings.size() && std::ranges::is_sorted(offsets),
          "segment offsets do not cover its postings");
  require(std::ranges::adjacent_find(words, std::ranges::greater_equal{}) == words.end(),
          "segment words do not ascend");
  for (std::size_t i = 0; i < words.size(); ++i) {
    const auto list = postings.subspan(offsets[i], offsets[i + 1] - offsets[i]);
    if (list.empty()) continue;
    require(std::ranges::adjacent_find(list, std::ranges::greater_equal{}, &Posting::vertex) == list.end(),
            "segment postings do not ascend by vertex");
    require(to_index(list.front().vertex) >= first && to_index(list.back().vertex) - first < count,
            "segment posting lies outside its vertices");
  }
  for (std::size_t i = 0; i < words.size(); ++i) {
    const auto list = postings.subspan(offsets[i], offsets[i + 1] - offsets[i]);
    std::vector<Posting>& to = at(words[i]);
    to.insert(to.end(), list.begin(), list.end());
  }
  vertices_ += count;
}

void InvertedIndex::truncate(std::uint32_t vertices) {
  if (vertices >= vertices_) return;
  for (std::vector<Posting>& list : by_word_) {
    while (!list.empty() && to_index(list.back().vertex) >= vertices) list.pop_back();
  }
  vertices_ = vertices;
}

std::span<const Posting> InvertedIndex::postings(WordId word) const {
  const std::size_t i = to_index(word);
  if (i >= by_word_.size()) return {};
  return by_word_[i];
}

void InvertedIndex::postings(WordId word, std::vector<Posting>& out) const {
  const auto list = postings(word);
  out.insert(out.end(), list.begin(), list.end());
}

std::span<const Posting> InvertedIndex::view(WordId word, std::vector<Posting>&) const { return postings(word); }

std::size_t InvertedIndex::memory_bytes() const {
  std::size_t bytes = sizeof(*this) + by_word_.capacity() * sizeof(by_word_[0]);
  for (const std::vector<Posting>& list : by_word_) bytes += list.capacity() * sizeof(Posting);
  return bytes;
}

}  // namespace mapweld
