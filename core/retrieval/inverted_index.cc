#include "core/retrieval/inverted_index.h"

#include <algorithm>
#include <functional>
#include <stdexcept>

#include "core/errors.h"

namespace mapweld {

PostingList PostingSource::postings(WordId word) const {
  PostingList all;
  visit(word, [&all](const Piece& piece) {
    const std::size_t before = all.size();
    all.append(piece.postings);
    for (std::size_t k = before; k < all.size(); ++k) {
      all.vertices[k] = VertexId{to_index(all.vertices[k]) + piece.shift};
    }
  });
  return all;
}

PostingList& InvertedIndex::at(WordId word) {
  const std::size_t i = to_index(word);
  if (i >= by_word_.size()) by_word_.resize(i + 1);
  return by_word_[i];
}

void InvertedIndex::add(const AppearanceVector& image) {
  std::vector<WordId> words;
  std::vector<VoteSignature> signatures;
  words.reserve(image.appearances.size());
  signatures.reserve(image.appearances.size());
  for (const Appearance& a : image.appearances) {
    words.push_back(a.word);
    signatures.push_back(vote_signature(a.signature));
  }
  add(words, signatures);
}

void InvertedIndex::add(std::span<const WordId> words, std::span<const VoteSignature> signatures) {
  if (!std::ranges::is_sorted(words) || words.size() != signatures.size()) {
    throw std::invalid_argument("appearances are not sorted by word");
  }
  const VertexId vertex{vertices_};
  for (std::size_t k = 0; k < words.size(); ++k) at(words[k]).add(vertex, signatures[k]);
  ++vertices_;
}

void InvertedIndex::add_segment(std::uint32_t first, std::uint32_t count, std::span<const WordId> words,
                                std::span<const std::uint32_t> offsets, const PostingSpan& postings) {
  const auto require = [](bool holds, const char* what) {
    if (!holds) throw FormatError(what);
  };
  require(first == vertices_ && count <= UINT32_MAX - first, "segment does not follow the index");
  require(postings.vertices.size() == postings.signatures.size(), "segment has not one signature a posting");
  require(offsets.size() == words.size() + 1, "segment has not one offset a word and one at the end");
  require(offsets.front() == 0 && offsets.back() == postings.size() && std::ranges::is_sorted(offsets),
          "segment offsets do not cover its postings");
  require(std::ranges::adjacent_find(words, std::ranges::greater_equal{}) == words.end(),
          "segment words do not ascend");
  for (std::size_t i = 0; i < words.size(); ++i) {
    const auto list = postings.vertices.subspan(offsets[i], offsets[i + 1] - offsets[i]);
    if (list.empty()) continue;
    require(std::ranges::is_sorted(list), "segment postings do not ascend by vertex");
    require(to_index(list.front()) >= first && to_index(list.back()) - first < count,
            "segment posting lies outside its vertices");
  }
  for (std::size_t i = 0; i < words.size(); ++i) at(words[i]).append(postings.part(offsets[i], offsets[i + 1]));
  vertices_ += count;
}

void InvertedIndex::truncate(std::uint32_t vertices) {
  if (vertices >= vertices_) return;
  for (PostingList& list : by_word_) {
    std::size_t size = list.size();
    while (size > 0 && to_index(list.vertices[size - 1]) >= vertices) --size;
    list.resize(size);
  }
  vertices_ = vertices;
}

PostingSpan InvertedIndex::find(WordId word) const {
  const std::size_t i = to_index(word);
  if (i >= by_word_.size()) return {};
  return by_word_[i];
}

void InvertedIndex::visit(WordId word, const Visitor& visitor) const {
  if (const PostingSpan all = find(word); !all.empty()) visitor({all, 0});
}

std::size_t InvertedIndex::memory_bytes() const {
  std::size_t bytes = sizeof(*this) + by_word_.capacity() * sizeof(by_word_[0]);
  for (const PostingList& list : by_word_) {
    bytes += list.vertices.capacity() * sizeof(VertexId) + list.signatures.capacity() * sizeof(VoteSignature);
  }
  return bytes;
}

}  // namespace mapweld
