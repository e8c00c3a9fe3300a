// What a merge reads: its members, their appearances and how a pair is verified. Never changed by it.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "core/geometry/pair_verifier.h"
#include "core/merge/merge_options.h"
#include "core/types.h"

namespace mapweld {

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
  std::vector<MergeMember> members;  // in the order given; two today
  std::vector<Edge> inner_edges;     // of all members
  std::shared_ptr<const AppearanceSource> appearances;
  std::shared_ptr<const PairVerifier> verifier;  // how a pair is verified
  std::shared_ptr<const VoteSource> votes;       // where candidates come from; null: the words of `appearances`
  MergeOptions options;
};

// Members of the given sizes, numbered one after the other from 0.
std::vector<MergeMember> number_members(const std::vector<std::uint32_t>& sizes);

// Which two members a pairwise method works on. m1 is the larger map, m2 the smaller; of two equal ones the later given
// is m2 (paper, section V: |V1| >= |V2|).
struct MemberPair {
  std::size_t m1 = 0;
  std::size_t m2 = 1;
};
MemberPair order_members(const std::vector<MergeMember>& members);

}  // namespace mapweld
