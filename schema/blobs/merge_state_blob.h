// The state of a merge (core/merge/merge_state.h) as named parts, so that a checkpoint writes only what can have
// changed.
//
// Every part is a frame of format 'M', version 1 (byte_stream.h), whose payload is: varint n, then a zstd frame that
// unpacks to n bytes, called the content. Integers in the content are varints unless said otherwise; "flags" are one
// bit each, the lowest first. A candidate is (source, target, votes).
//
// part           changes           content
// "state"        always            method (length, bytes); input_fingerprint, rules_fingerprint (u64 little-endian);
//                                  vertices; phase (byte); step; verifications; candidates_known; random (u64
//                                  little-endian); inherited_edges; inherited_rejected; pair; words_processed;
//                                  word_in_hand + 1 (0: none); word_next_row; pending: count, next, candidates; number
//                                  of postponed candidates, next; next_row; attempts; drawn: count, numbers; number of
//                                  edges; number of rejected pairs
// "similarity"   voting,           is_sparse (byte); rows; columns; sparse only: rows kept so far, then for each row
// the
//                exploration       number of its cells and each cell's column as distance from the one before; then
//                                  the low bytes of all cells, then their high bytes (dense: row-major)
// "queue"        exploration       number of words; flags of processed words; the words' priorities; number of
//                                  sources; flags of processed sources
// "postponed"    exploration       the candidates of L, in order
// "rejected-NNNNNN" when it grows  page NNNNNN of the rejected pairs, kRejectedPerPage each but the last: for each
//                                  source, target, reason (byte), matches, inliers, votes
// "absent"         when images go   one byte, 1 when edges were purged since (merge_state_store.h); number of vertices,
// each
//                  or come back     as distance from the one before; not there: none
//
// The edges are not in here: they stand in their own table, written in the same transaction.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/merge/merge_state.h"
#include "schema/blobs/byte_stream.h"

namespace mapweld::blobs {

inline constexpr std::size_t kRejectedPerPage = 8192;

struct MergeStatePart {
  std::string name;
  Bytes bytes;
};

// What of a state is stored already; tells the next checkpoint what to leave out.
struct MergeStateMark {
  MergePhase phase = MergePhase::kVoting;
  std::uint32_t pair = 0;
  std::uint64_t inherited = 0;
  std::uint64_t rejected = 0;
};
MergeStateMark mark_of(const MergeState& state);

// The parts that can have changed since a state with this mark was stored; all of them when there is none.
std::vector<MergeStatePart> encode_merge_state(const MergeState& state, const std::optional<MergeStateMark>& stored);

// The state that was encoded; `edges` are its edges in order of insertion. Throws StoreError: kCorrupt when a part is
// missing, torn, foreign or does not agree with the others, kNewerVersion.
MergeState decode_merge_state(std::span<const MergeStatePart> parts, std::vector<MergeEdge> edges);

// The name of page `page` of the rejected pairs, from 0.
std::string rejected_page_name(std::size_t page);
// The rejected pairs of such a page alone, in order. Throws StoreError as decode_merge_state.
std::vector<RejectedPair> decode_rejected_page(const MergeStatePart& page);

}  // namespace mapweld::blobs
