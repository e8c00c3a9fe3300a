// The inverted index of one map, in memory: word -> postings (Sivic & Zisserman 2003).
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "core/retrieval/postings.h"
#include "core/types.h"

namespace mapweld {

// Where votes come from: an in-memory index, or segments read from a store.
class PostingSource {
 public:
  virtual ~PostingSource() = default;

  // Some of a word's postings where they lie; vertex v among them is the source's vertex v + shift (modulo 2^32).
  struct Piece {
    PostingSpan postings;
    std::uint32_t shift = 0;
  };
  using Visitor = std::function<void(const Piece&)>;
  // Shows the postings of `word`, of vertices below `vertices()`, in pieces ascending by vertex, all of a vertex in one
  // piece, no piece empty. A piece is valid while it is visited.
  virtual void visit(WordId word, const Visitor& visitor) const = 0;
  // Number of vertices; ids are 0 .. vertices()-1.
  virtual std::uint32_t vertices() const = 0;

  // All of them in one list.
  PostingList postings(WordId word) const;
};

// Grows by whole vertices, ids ascending without gaps. One writer at a time, or any number of readers.
class InvertedIndex final : public PostingSource {
 public:
  // Adds the next vertex (id = vertices()); `image` has its appearances sorted by word.
  // Throws std::invalid_argument, and changes nothing, when they are not sorted.
  void add(const AppearanceVector& image);
  // The same, of what the index keeps: the words of the image's features, each with its signature.
  void add(std::span<const WordId> words, std::span<const VoteSignature> signatures);
  // Adds the vertices first .. first+count-1 at once, first = vertices(): `words[i]` ascending with its postings
  // [offsets[i], offsets[i+1]) of `postings`. This is how a stored segment arrives.
  // Throws FormatError, and changes nothing, when the parts do not fit together.
  void add_segment(std::uint32_t first, std::uint32_t count, std::span<const WordId> words,
                   std::span<const std::uint32_t> offsets, const PostingSpan& postings);
  // Forgets the vertices from `vertices` on (a commit that failed). Cost: a look at every word.
  void truncate(std::uint32_t vertices);

  void visit(WordId word, const Visitor& visitor) const override;
  // The same in one piece; valid until the index changes.
  PostingSpan find(WordId word) const;
  std::uint32_t vertices() const override { return vertices_; }
  // What the index occupies, unused capacity included.
  std::size_t memory_bytes() const;

 private:
  PostingList& at(WordId word);

  std::vector<PostingList> by_word_;  // indexed by word id, grown on demand
  std::uint32_t vertices_ = 0;
};

}  // namespace mapweld
