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

struct Votes {
  std::vector<VotedVertex> candidates;  // votes >= min_votes; by votes descending, then vertex ascending
  std::uint32_t known_words = 0;        // distinct words of the query that the map has
};

// Votes over the whole map; exact for all rules. A vertex without a vote is no candidate, not even with min_votes = 0.
// Cost: the postings of the query's words and one pass over a counter a vertex, which the thread keeps for its next
// query. Thread-safe when `map` is.
Votes vote(const AppearanceVector& query, const PostingSource& map, VoteRule rule, std::uint32_t min_votes);

// S of two images directly.
std::uint32_t pair_votes(const AppearanceVector& a, const AppearanceVector& b, VoteRule rule);

}  // namespace mapweld
