// A block of a segment of the inverted index as bytes: the postings of some consecutive words, about 9.5 bytes each
// with signatures, 1.5 without.
//
// Frame 'P', version 2 with signatures, 1 when no posting has one (byte_stream.h). Payload: varint n; then for each of
// the n words a varint, its distance from the word before it (from 0 for the first), and a varint, the bytes of its
// list; then the lists. In a list each vertex is a varint g * 2 + m and, when m is 1, a varint count - 2: g is the
// number of vertices passed over since the vertex before it (since the segment's first vertex for the first), m says
// whether it has more than one posting. In version 2 the signature of each posting follows, a little-endian u64 of the
// bits that core/retrieval/vote_signature.h chooses, so that what is left of the list tells where the vertices end.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/retrieval/postings.h"
#include "schema/blobs/byte_stream.h"

namespace mapweld::blobs {

// Cuts the postings of a segment into blocks. Words come ascending, each with its postings ascending by vertex.
class PostingBlockWriter {
 public:
  // A block is closed when its payload reaches `target_bytes`; a word's list is never cut.
  // `with_signatures`: version 2.
  PostingBlockWriter(VertexId first_vertex, std::size_t target_bytes, bool with_signatures);

  void add(WordId word, const PostingSpan& postings);

  struct Block {
    WordId first_word{};
    Bytes bytes;
  };
  // Closes the last block and hands out all of them.
  std::vector<Block> finish() &&;

 private:
  void close();
  VertexId first_vertex_;
  std::size_t target_bytes_;
  bool with_signatures_;
  std::vector<Block> blocks_;
  std::vector<std::pair<WordId, std::uint32_t>> directory_;  // word, bytes of its list
  Bytes lists_;
};

// One block, its directory read. The bytes must outlive it. Throws StoreError (kCorrupt, kNewerVersion), as its
// functions.
class PostingBlock {
 public:
  PostingBlock(std::span<const std::uint8_t> blob, VertexId first_vertex, std::uint32_t vertices);

  std::size_t words() const { return directory_.size(); }
  WordId word(std::size_t i) const { return directory_[i].word; }
  // Appends the postings of the i-th word.
  void postings(std::size_t i, PostingList& out) const;
  // Appends those of a word, if it is in the block.
  void find(WordId word, PostingList& out) const;

 private:
  struct Entry {
    WordId word{};
    std::uint32_t begin = 0;  // of its list, in lists_
    std::uint32_t end = 0;
  };
  std::vector<Entry> directory_;
  std::span<const std::uint8_t> lists_;
  std::uint32_t first_vertex_;
  std::uint32_t vertices_;
  bool with_signatures_;
};

}  // namespace mapweld::blobs
