// The inverted index of one map, in memory: word -> postings (Sivic & Zisserman 2003).
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/types.h"

namespace mapweld {

// Where votes come from: an in-memory index, or segments read from a store.
class PostingSource {
 public:
  virtual ~PostingSource() = default;
  // Appends to `out` the postings of `word`, ascending by vertex, of vertices below `vertices()`.
  virtual void postings(WordId word, std::vector<Posting>& out) const = 0;
  // Number of vertices; ids are 0 .. vertices()-1.
  virtual std::uint32_t vertices() const = 0;
};

// Grows by whole vertices, ids ascending without gaps. One writer at a time, or any number of readers.
class InvertedIndex final : public PostingSource {
 public:
  // Adds the next vertex (id = vertices()); `image` has its appearances sorted by word.
  void add(const AppearanceVector& image);
  // Adds the vertices first .. first+count-1 at once, first = vertices(): `words[i]` ascending with its postings
  // `postings[offsets[i] .. offsets[i+1])`, ascending by vertex. This is how a stored segment arrives.
  void add_segment(std::uint32_t first, std::uint32_t count, std::span<const WordId> words,
                   std::span<const std::uint32_t> offsets, std::span<const Posting> postings);
  // Forgets the vertices from `vertices` on (a commit that failed).
  void truncate(std::uint32_t vertices);

  void postings(WordId word, std::vector<Posting>& out) const override;
  std::span<const Posting> postings(WordId word) const;
  std::uint32_t vertices() const override { return vertices_; }
  std::size_t memory_bytes() const;

 private:
  std::vector<std::vector<Posting>> by_word_;  // indexed by word id, grown on demand
  std::uint32_t vertices_ = 0;
};

}  // namespace mapweld
