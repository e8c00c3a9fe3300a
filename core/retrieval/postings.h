// Postings: which images have a word, one entry a feature.
#pragma once

#include <algorithm>
#include <cstddef>
#include <span>
#include <vector>

#include "core/retrieval/vote_signature.h"
#include "core/types.h"

namespace mapweld {

// The postings of one word, ascending by vertex: posting k says that vertices[k] has a feature with the word, whose
// signature for votes is signatures[k]. A vertex has as many, one after the other, as it has features with the word, in
// the order of its appearances.
struct PostingSpan {
  std::span<const VertexId> vertices;
  std::span<const VoteSignature> signatures;

  std::size_t size() const { return vertices.size(); }
  bool empty() const { return vertices.empty(); }
  PostingSpan part(std::size_t from, std::size_t to) const {
    return {vertices.subspan(from, to - from), signatures.subspan(from, to - from)};
  }
  // Those of the vertices [first, end).
  PostingSpan between(VertexId first, VertexId end) const {
    const auto from = std::ranges::lower_bound(vertices, first);
    const auto to = std::lower_bound(from, vertices.end(), end);
    return part(static_cast<std::size_t>(from - vertices.begin()), static_cast<std::size_t>(to - vertices.begin()));
  }
};

// The same, owned.
struct PostingList {
  std::vector<VertexId> vertices;
  std::vector<VoteSignature> signatures;

  void add(VertexId vertex, VoteSignature signature) {
    vertices.push_back(vertex);
    signatures.push_back(signature);
  }
  void append(const PostingSpan& postings) {
    vertices.insert(vertices.end(), postings.vertices.begin(), postings.vertices.end());
    signatures.insert(signatures.end(), postings.signatures.begin(), postings.signatures.end());
  }
  void resize(std::size_t size) {
    vertices.resize(size);
    signatures.resize(size);
  }
  void clear() { resize(0); }
  std::size_t size() const { return vertices.size(); }
  operator PostingSpan() const { return {vertices, signatures}; }
  friend bool operator==(const PostingList&, const PostingList&) = default;
};

inline constexpr std::size_t kBytesPerPosting = sizeof(VertexId) + sizeof(VoteSignature);

// The end of the postings of one vertex that begin at `from`.
inline std::size_t end_of_vertex(std::span<const VertexId> vertices, std::size_t from) {
  std::size_t to = from + 1;
  while (to < vertices.size() && vertices[to] == vertices[from]) ++to;
  return to;
}

// How many vertices have one of these postings.
inline std::size_t count_vertices(std::span<const VertexId> vertices) {
  std::size_t count = 0;
  for (std::size_t k = 0; k < vertices.size(); ++k) count += k == 0 || vertices[k] != vertices[k - 1] ? 1 : 0;
  return count;
}

}  // namespace mapweld
