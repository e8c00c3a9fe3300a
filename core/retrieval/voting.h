// Voting: the similarity S_k^q of a query to every vertex of a map (paper, section III-A).
#pragma once

#include <cstdint>
#include <vector>

#include "core/retrieval/inverted_index.h"
#include "core/types.h"

namespace mapweld {

struct VotedVertex {
  VertexId vertex{};
  std::uint32_t votes = 0;
  friend auto operator<=>(const VotedVertex&, const VotedVertex&) = default;
};

// How often each word appears in the image (saturates at 65535); ascending by word.
struct WordCount {
  WordId word{};
  std::uint16_t count = 0;
  friend auto operator<=>(const WordCount&, const WordCount&) = default;
};
std::vector<WordCount> count_words(const AppearanceVector& image);

// What one word that appears `a` and `b` times in two images adds to their S.
constexpr std::uint32_t word_votes(std::uint16_t a, std::uint16_t b, VoteRule rule) {
  return rule == VoteRule::kProduct ? std::uint32_t{a} * b : std::uint32_t{a < b ? a : b};
}

struct Votes {
  std::vector<VotedVertex> candidates;  // votes >= min_votes; by votes descending, then vertex ascending
  std::uint32_t known_words = 0;        // distinct words of the query that the map has
};

// Votes over the whole map; exact for both rules, as long as images have at most 65535 appearances. A vertex without a
// common word is no candidate, not even with min_votes = 0. Cost: the postings of the query's words and one pass over
// a counter a vertex, which the thread keeps for its next query. Thread-safe when `map` is.
Votes vote(const AppearanceVector& query, const PostingSource& map, VoteRule rule, std::uint32_t min_votes);

// S of two images directly: the oracle of `vote`, and the votes of a single pair.
std::uint32_t pair_votes(const AppearanceVector& a, const AppearanceVector& b, VoteRule rule);

}  // namespace mapweld
