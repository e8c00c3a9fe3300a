// The inverted index of one map, in memory: word -> postings (Sivic & Zisserman 2003).
#pragma once

#include <cstddef>
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

  // The same postings without a copy where the source holds them in one piece; otherwise they are written to
  // `scratch` (what was in it is lost). Valid until the source changes or `scratch` does.
  virtual std::span<const Posting> view(WordId word, std::vector<Posting>& scratch) const {
    scratch.clear();
    postings(word, scratch);
    return scratch;
  }
};

// Grows by whole vertices, ids ascending without gaps. One writer at a time, or any number of readers.
class InvertedIndex final : public PostingSource {
 public:
  // Adds the next vertex (id = vertices()); `image` has its appearances sorted by word.
  // Throws std::invalid_argument, and changes nothing, when they are not sorted.
  void add(const AppearanceVector& image);
  // Adds the vertices first .. first+count-1 at once, first = vertices(): `words[i]` ascending with its postings
  // `postings[offsets[i] .. offsets[i+1])`, ascending by vertex. This is how a stored segment arrives.
  // Throws FormatError, and changes nothing, when the parts do not fit together.
  void add_segment(std::uint32_t first, std::uint32_t count, std::span<const WordId> words,
                   std::span<const std::uint32_t> offsets, std::span<const Posting> postings);
  // Forgets the vertices from `vertices` on (a commit that failed). Cost: a look at every word.
  void truncate(std::uint32_t vertices);

  void postings(WordId word, std::vector<Posting>& out) const override;
  std::span<const Posting> postings(WordId word) const;
  std::span<const Posting> view(WordId word, std::vector<Posting>& scratch) const override;
  std::uint32_t vertices() const override { return vertices_; }
  // What the index occupies, unused capacity included.
  std::size_t memory_bytes() const;

 private:
  std::vector<Posting>& at(WordId word);

  std::vector<std::vector<Posting>> by_word_;  // indexed by word id, grown on demand
  std::uint32_t vertices_ = 0;
};

}  // namespace mapweld
