// Everything a merge remembers, as one value. A checkpoint writes it, a resume constructs from it.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "core/merge/similarity_matrix.h"
#include "core/types.h"

namespace mapweld {

enum class MergePhase : std::uint8_t {
  kVoting,        // S is being prepared; nothing is verified
  kExploration,   // QuickConnect, Algorithm 1, lines 3 to 10
  kVerification,  // methods without stages: candidates are verified in the method's order
  kRefinement,    // QuickConnect, Algorithm 1, lines 11 to 14
  kDone,
};
std::string_view to_string(MergePhase phase);  // the word of http-api.md

// An inter-map edge, as it was inserted. u < v, merged numbers; geometry and matches run from u to v.
struct MergeEdge {
  VertexId u{};
  VertexId v{};
  std::uint32_t votes = 0;          // final votes
  Verification verification;        // of (u, v); its inliers are the edge's weight
  std::uint64_t verifications = 0;  // how many the merge had made, this one included
  friend bool operator==(const MergeEdge&, const MergeEdge&) = default;
};

// A candidate that the verifier refused.
struct RejectedPair {
  VertexId source{};
  VertexId target{};
  Reason reason = Reason::kNone;
  std::uint16_t matches = 0;
  std::uint16_t inliers = 0;
  std::uint32_t votes = 0;  // when it was verified: final, but in exploration
  friend bool operator==(const RejectedPair&, const RejectedPair&) = default;
};

// What the search for candidates between m2 (rows) and m1 (columns) remembers. Sources and targets are merged numbers,
// rows and words are indices into the VoteSource.
struct PairSearch {
  SimilarityMatrix similarity;               // S
  std::vector<std::uint32_t> priorities;     // W: of every word, processed ones included
  std::vector<std::uint8_t> word_processed;  // W: 1 once the word's votes have been taken up
  std::uint32_t words_processed = 0;
  // A word whose pairs are more than one step's work is voted for in parts; `word_in_hand` is kNoWord between words.
  static constexpr std::uint32_t kNoWord = 0xFFFFFFFF;
  std::uint32_t word_in_hand = kNoWord;
  std::uint32_t word_next_row = 0;  // index into its row postings; alignment: transitions after the last row's votes
  std::vector<Candidate> pending;   // E: new candidates, in the order in which they are taken
  std::uint64_t pending_next = 0;
  std::vector<Candidate> postponed;  // L; alignment: the candidates of its alignments
  std::uint64_t postponed_next = 0;
  std::vector<std::uint8_t> source_processed;  // by row: an edge was inserted from it
  std::uint32_t next_row = 0;                  // brute force, voting: the next image of m2
  std::uint64_t attempts = 0;                  // random methods: pairs drawn so far
  std::vector<std::uint32_t> drawn;            // degree-min: by row, how many of its targets have been drawn
  friend bool operator==(const PairSearch&, const PairSearch&) = default;
};

struct MergeState {
  std::string method;
  std::uint64_t input_fingerprint = 0;  // a state resumes only on the members that it came from,
  std::uint64_t rules_fingerprint = 0;  // with the method, options and verifier that it came from
  std::uint32_t vertices = 0;           // of the merged map
  MergePhase phase = MergePhase::kExploration;
  std::uint64_t step = 0;              // transitions made
  std::uint64_t verifications = 0;     // candidates with a verdict = edges + rejected
  std::uint64_t candidates_known = 0;  // pairs that have reached min_votes
  std::uint64_t random = 0;            // state of core/random.h
  // So many of `edges` and `rejected`, from the front, were there before the maps grew.
  std::uint64_t inherited_edges = 0;
  std::uint64_t inherited_rejected = 0;
  // Of members, that `search` is about, in the order in which pairs are merged; spectral: whose votes are taken up,
  // while the candidates are those of all pairs so far.
  std::uint32_t pair = 0;
  PairSearch search;
  std::vector<MergeEdge> edges;        // in order of insertion
  std::vector<RejectedPair> rejected;  // in order of verification
  friend bool operator==(const MergeState&, const MergeState&) = default;
};

}  // namespace mapweld
