#include "schema/blobs/merge_state_blob.h"

#include <algorithm>
#include <cstdio>
#include <string_view>
#include <utility>

#include "core/errors.h"
#include "schema/blobs/merge_state_content.h"

namespace mapweld::blobs {
namespace {

std::size_t rejected_pages(std::size_t rejected) { return (rejected + kRejectedPerPage - 1) / kRejectedPerPage; }

MergeStatePart encode_state(const MergeState& state) {
  const PairSearch& search = state.search;
  MergeStateContent content;
  content.text(state.method);
  content.u64(state.input_fingerprint);
  content.u64(state.rules_fingerprint);
  content.varint(state.vertices);
  content.u8(static_cast<std::uint8_t>(state.phase));
  content.varint(state.step);
  content.varint(state.verifications);
  content.varint(state.candidates_known);
  content.u64(state.random);
  content.varint(state.inherited_edges);
  content.varint(state.inherited_rejected);
  content.varint(state.pair);
  content.varint(search.words_processed);
  content.varint(search.word_in_hand == PairSearch::kNoWord ? 0 : std::uint64_t{search.word_in_hand} + 1);
  content.varint(search.word_next_row);
  content.varint(search.pending.size());
  content.varint(search.pending_next);
  for (const Candidate& c : search.pending) content.candidate(c);
  content.varint(search.postponed.size());
  content.varint(search.postponed_next);
  content.varint(search.next_row);
  content.varint(search.attempts);
  content.varint(search.drawn.size());
  for (const std::uint32_t drawn : search.drawn) content.varint(drawn);
  content.varint(state.edges.size());
  content.varint(state.rejected.size());
  return std::move(content).pack("state");
}

// What the other parts must agree with.
struct Totals {
  std::uint64_t postponed = 0;
  std::uint64_t edges = 0;
  std::uint64_t rejected = 0;
};

Totals decode_state(const MergeStatePart& part, MergeState& state) {
  PairSearch& search = state.search;
  MergeStateContentReader content(part);
  Totals totals;
  state.method = content.text();
  state.input_fingerprint = content.u64();
  state.rules_fingerprint = content.u64();
  state.vertices = content.varint32();
  const std::uint8_t phase = content.u8();
  if (phase > static_cast<std::uint8_t>(MergePhase::kDone)) content.fail();
  state.phase = static_cast<MergePhase>(phase);
  state.step = content.varint();
  state.verifications = content.varint();
  state.candidates_known = content.varint();
  state.random = content.u64();
  state.inherited_edges = content.varint();
  state.inherited_rejected = content.varint();
  state.pair = content.varint32();
  search.words_processed = content.varint32();
  const std::uint64_t word = content.varint();
  if (word > UINT32_MAX) content.fail();
  search.word_in_hand = word == 0 ? PairSearch::kNoWord : static_cast<std::uint32_t>(word - 1);
  search.word_next_row = content.varint32();
  search.pending.resize(content.count());
  search.pending_next = content.varint();
  for (Candidate& c : search.pending) c = content.candidate();
  totals.postponed = content.varint();
  search.postponed_next = content.varint();
  search.next_row = content.varint32();
  search.attempts = content.varint();
  search.drawn.resize(content.count());
  for (std::uint32_t& drawn : search.drawn) drawn = content.varint32();
  totals.edges = content.varint();
  totals.rejected = content.varint();
  content.finish();
  return totals;
}

MergeStatePart encode_similarity(const SimilarityMatrix& matrix) {
  MergeStateContent content;
  content.u8(matrix.is_sparse() ? 1 : 0);
  content.varint(matrix.rows());
  content.varint(matrix.columns());
  if (matrix.is_sparse()) {
    const auto offsets = matrix.offsets();
    content.varint(matrix.appended_rows());
    for (std::uint32_t row = 0; row < matrix.appended_rows(); ++row) {
      content.varint(offsets[row + 1] - offsets[row]);
      std::uint32_t before = 0;
      for (std::uint64_t k = offsets[row]; k < offsets[row + 1]; ++k) {
        content.varint(matrix.kept_columns()[k] - before);
        before = matrix.kept_columns()[k];
      }
    }
  }
  content.planes(matrix.votes());
  return std::move(content).pack("similarity");
}

SimilarityMatrix decode_similarity(const MergeStatePart& part) {
  MergeStateContentReader content(part);
  const bool is_sparse = content.u8() != 0;
  const std::uint32_t rows = content.varint32(), columns = content.varint32();
  std::uint64_t cells = std::uint64_t{rows} * columns;
  std::vector<std::uint64_t> offsets;
  std::vector<std::uint32_t> kept;
  if (is_sparse) {
    offsets.assign(1, 0);
    for (std::size_t left = content.count(); left > 0; --left) {
      std::uint32_t column = 0;
      for (std::size_t k = content.count(); k > 0; --k) kept.push_back(column += content.varint32());
      offsets.push_back(kept.size());
    }
    cells = kept.size();
  }
  std::vector<std::uint16_t> votes = content.planes(cells);
  content.finish();
  return SimilarityMatrix::restore(is_sparse, rows, columns, std::move(offsets), std::move(kept), std::move(votes));
}

MergeStatePart encode_queue(const PairSearch& search) {
  MergeStateContent content;
  content.varint(search.priorities.size());
  content.flags(search.word_processed);
  for (const std::uint32_t priority : search.priorities) content.varint(priority);
  content.varint(search.source_processed.size());
  content.flags(search.source_processed);
  return std::move(content).pack("queue");
}

void decode_queue(const MergeStatePart& part, PairSearch& search) {
  MergeStateContentReader content(part);
  search.priorities.resize(content.count());
  search.word_processed = content.flags(search.priorities.size());
  for (std::uint32_t& priority : search.priorities) priority = content.varint32();
  search.source_processed = content.flags(content.varint());
  content.finish();
}

MergeStatePart encode_postponed(const PairSearch& search) {
  MergeStateContent content;
  for (const Candidate& c : search.postponed) content.candidate(c);
  return std::move(content).pack("postponed");
}

void decode_postponed(const MergeStatePart& part, std::uint64_t count, PairSearch& search) {
  MergeStateContentReader content(part);
  search.postponed.reserve(std::min<std::uint64_t>(count, 1 << 20));
  for (std::uint64_t i = 0; i < count; ++i) search.postponed.push_back(content.candidate());
  content.finish();
}

MergeStatePart encode_rejected_page(const std::vector<RejectedPair>& rejected, std::size_t page) {
  MergeStateContent content;
  const std::size_t end = std::min(rejected.size(), (page + 1) * kRejectedPerPage);
  for (std::size_t i = page * kRejectedPerPage; i < end; ++i) {
    content.varint(to_index(rejected[i].source));
    content.varint(to_index(rejected[i].target));
    content.u8(static_cast<std::uint8_t>(rejected[i].reason));
    content.varint(rejected[i].matches);
    content.varint(rejected[i].inliers);
    content.varint(rejected[i].votes);
  }
  return std::move(content).pack(rejected_page_name(page));
}

RejectedPair read_rejected_pair(MergeStateContentReader& content) {
  const auto u16 = [&content] {
    const std::uint32_t value = content.varint32();
    if (value > UINT16_MAX) content.fail();
    return static_cast<std::uint16_t>(value);
  };
  RejectedPair pair;
  pair.source = VertexId{content.varint32()};
  pair.target = VertexId{content.varint32()};
  const std::uint8_t reason = content.u8();
  if (reason > static_cast<std::uint8_t>(Reason::kAmbiguous)) content.fail();
  pair.reason = static_cast<Reason>(reason);
  pair.matches = u16();
  pair.inliers = u16();
  pair.votes = content.varint32();
  return pair;
}

void read_rejected_page(const MergeStatePart& part, std::uint64_t count, std::vector<RejectedPair>& rejected) {
  MergeStateContentReader content(part);
  for (std::uint64_t i = 0; i < count; ++i) rejected.push_back(read_rejected_pair(content));
  content.finish();
}

const MergeStatePart& find_part(std::span<const MergeStatePart> parts, std::string_view name) {
  const auto found = std::ranges::find(parts, name, &MergeStatePart::name);
  if (found == parts.end()) corrupt_merge_state("part '" + std::string(name) + "' is missing");
  return *found;
}

// Whether the search itself (S, W, L) may still change in this phase; verification and refinement only walk along it.
bool search_is_open(MergePhase phase) { return phase == MergePhase::kVoting || phase == MergePhase::kExploration; }

}  // namespace

MergeStateMark mark_of(const MergeState& state) {
  return {state.phase, state.pair, state.inherited_edges + state.inherited_rejected, state.rejected.size()};
}

std::vector<MergeStatePart> encode_merge_state(const MergeState& state, const std::optional<MergeStateMark>& stored) {
  std::vector<MergeStatePart> parts;
  parts.push_back(encode_state(state));
  const bool is_another_search =
      stored && (stored->pair != state.pair || stored->inherited != state.inherited_edges + state.inherited_rejected);
  if (!stored || is_another_search || search_is_open(stored->phase)) {
    parts.push_back(encode_similarity(state.search.similarity));
    parts.push_back(encode_queue(state.search));
    parts.push_back(encode_postponed(state.search));
  }
  if (!stored || stored->rejected < state.rejected.size()) {
    const std::size_t first = stored ? stored->rejected / kRejectedPerPage : 0;
    for (std::size_t page = first; page < rejected_pages(state.rejected.size()); ++page) {
      parts.push_back(encode_rejected_page(state.rejected, page));
    }
  }
  return parts;
}

std::string rejected_page_name(std::size_t page) {
  char name[32];
  std::snprintf(name, sizeof(name), "rejected-%06zu", page);
  return name;
}

std::vector<RejectedPair> decode_rejected_page(const MergeStatePart& page) {
  try {
    std::vector<RejectedPair> rejected;
    for (MergeStateContentReader content(page); !content.at_end();) rejected.push_back(read_rejected_pair(content));
    return rejected;
  } catch (const FormatError& error) {
    corrupt_merge_state(error.what());
  }
}

MergeState decode_merge_state(std::span<const MergeStatePart> parts, std::vector<MergeEdge> edges) {
  try {
    MergeState state;
    const Totals totals = decode_state(find_part(parts, "state"), state);
    if (totals.edges != edges.size()) {
      corrupt_merge_state("it counts " + std::to_string(totals.edges) + " edges, of which " +
                          std::to_string(edges.size()) + " are stored");
    }
    state.edges = std::move(edges);
    state.search.similarity = decode_similarity(find_part(parts, "similarity"));
    decode_queue(find_part(parts, "queue"), state.search);
    decode_postponed(find_part(parts, "postponed"), totals.postponed, state.search);
    for (std::size_t page = 0; page < rejected_pages(totals.rejected); ++page) {
      const std::uint64_t count = std::min<std::uint64_t>(kRejectedPerPage, totals.rejected - page * kRejectedPerPage);
      read_rejected_page(find_part(parts, rejected_page_name(page)), count, state.rejected);
    }
    return state;
  } catch (const FormatError& error) {
    corrupt_merge_state(error.what());
  }
}

}  // namespace mapweld::blobs
