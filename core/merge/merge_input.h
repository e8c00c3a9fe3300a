// What a merge reads: its members, their appearances and how a pair is verified. Never changed by it.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "core/geometry/pair_verifier.h"
#include "core/merge/merge_options.h"
#include "core/types.h"

namespace mapweld {

class Executor;
class VoteSource;

// Numbers: the merged map numbers its vertices member by member, in the order given (http-api.md, "Numbers"); all ids
// here are merged numbers, unless they are said to be a member's own.
struct MergeMember {
  // The merged number of each of the member's vertices, ascending: vertices[i] is the member's own vertex i.
  std::vector<VertexId> vertices;
};

// The appearance vectors of the merged map's vertices.
class AppearanceSource {
 public:
  virtual ~AppearanceSource() = default;
  // Thread-safe. Throws on I/O errors of a store behind it; the step that asked has then changed nothing.
  virtual std::shared_ptr<const AppearanceVector> appearances(VertexId vertex) const = 0;
};

// All vectors in memory; vectors[i] belongs to merged vertex i.
class AppearanceTable final : public AppearanceSource {
 public:
  explicit AppearanceTable(std::vector<std::shared_ptr<const AppearanceVector>> vectors)
      : vectors_(std::move(vectors)) {}
  std::shared_ptr<const AppearanceVector> appearances(VertexId vertex) const override {
    return vectors_.at(to_index(vertex));
  }

 private:
  std::vector<std::shared_ptr<const AppearanceVector>> vectors_;
};

struct MergeInput {
  std::vector<MergeMember> members;  // in the order given; two or more
  std::vector<Edge> inner_edges;     // of all members
  // Ascending: vertices whose images are gone. They have no appearances and no edges, and a verdict about one of them,
  // from before it went, counts for nothing.
  std::vector<VertexId> absent;
  std::shared_ptr<const AppearanceSource> appearances;
  std::shared_ptr<const PairVerifier> verifier;  // how a pair is verified
  // Where the candidates of a merge of two members come from; null, and with more members: the words of `appearances`.
  std::shared_ptr<const VoteSource> votes;
  // Verifies pairs ahead, many at once; null: one by one, when their turn comes. The merge is the same.
  std::shared_ptr<const Executor> executor;
  MergeOptions options;
};

// Members of the given sizes, numbered one after the other from 0.
std::vector<MergeMember> number_members(const std::vector<std::uint32_t>& sizes);

// Which two members are merged with each other. m1 is the larger map, m2 the smaller; of two equal ones the later given
// is m2 (paper, section V: |V1| >= |V2|).
struct MemberPair {
  std::size_t m1 = 0;
  std::size_t m2 = 1;
  friend auto operator<=>(const MemberPair&, const MemberPair&) = default;
};
// Of two members, i < j.
MemberPair order_members(const std::vector<MergeMember>& members, std::size_t i = 0, std::size_t j = 1);
// All pairs of members: (0, 1), (0, 2), ..., (1, 2), ...
std::vector<MemberPair> all_member_pairs(const std::vector<MergeMember>& members);
// Where the pair of members i and j, in either order, stands in that list.
std::size_t place_of_pair(std::size_t i, std::size_t j, std::size_t members);

}  // namespace mapweld
