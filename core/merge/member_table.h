// What a merge has found between each two of its members.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "core/merge/merge_input.h"
#include "core/merge/merge_state.h"

namespace mapweld {

enum class JoinVerdict : std::uint8_t {
  kJoined,     // a confirmed edge joins them
  kNotJoined,  // all their candidates have been verified, and there is no edge
  kAmbiguous,  // there are verified edges, none of them confirmed
  kUndecided,  // no edge yet, and not all their candidates have been verified
};
std::string_view to_string(JoinVerdict verdict);  // the word of docs/http-api.md

struct MemberPairSummary {
  std::uint32_t first = 0;  // member, in the order given; first < second
  std::uint32_t second = 0;
  std::uint64_t verified = 0;           // candidates with a verdict
  std::uint64_t accepted = 0;           // of them, edges
  std::uint64_t confirmed = 0;          // of those
  std::uint32_t independent_joins = 0;  // maximum matching of the confirmed edges
  JoinVerdict verdict = JoinVerdict::kUndecided;
  friend bool operator==(const MemberPairSummary&, const MemberPairSummary&) = default;
};

// All pairs of members, (0, 1), (0, 2), ... `confirmed`: by edge; empty: all are. `finished`: by pair, whether all its
// candidates have a verdict (Merger::finished_pairs).
std::vector<MemberPairSummary> member_table(const std::vector<MergeMember>& members, std::span<const MergeEdge> edges,
                                            std::span<const RejectedPair> rejected, const std::vector<bool>& confirmed,
                                            const std::vector<bool>& finished);

}  // namespace mapweld
