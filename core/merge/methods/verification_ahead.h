// Verdicts reached before their turn: the candidates that will be asked for next are verified together, on all cores.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <unordered_map>
#include <vector>

#include "core/merge/merge_input.h"
#include "core/types.h"

namespace mapweld {

// A verdict is a pure function of its pair. So this is a cache and no part of a merge's state: a wrong guess at what
// comes next costs time and changes nothing. So is what the verifier has prepared of the images that it was asked
// about. Used by one thread.
class VerificationAhead {
 public:
  // Pairs of one batch; fixed, so that a step stays short.
  static constexpr std::size_t kBatch = 32;
  // Verdicts that are kept for a turn that has not come; past that, all are forgotten.
  static constexpr std::size_t kMostKept = std::size_t{1} << 16;

  // Images that are kept prepared; past that, all are forgotten.
  static constexpr std::size_t kMostPrepared = 4096;

  // `input` must outlive this.
  explicit VerificationAhead(const MergeInput& input) : input_(input) {}

  // Appends to its argument up to so many candidates, in the order in which they are expected to be asked for.
  using Upcoming = std::function<void(std::size_t most, std::vector<Candidate>& candidates)>;

  // The verdict on (u, v), u < v. When it is not known yet and there is an executor of two threads or more, the
  // `upcoming` pairs are verified along with it. What cannot be read for those is left for their own turn; what cannot
  // be read for (u, v) throws.
  Verification take(VertexId u, VertexId v, const Upcoming& upcoming);

 private:
  Verification verify(VertexId u, VertexId v);
  std::shared_ptr<const PreparedImage> prepared(VertexId vertex);
  void verify_batch(VertexId u, VertexId v, const Upcoming& upcoming);

  const MergeInput& input_;
  std::unordered_map<std::uint64_t, Verification> verdicts_;  // by both ends
  std::unordered_map<VertexId, std::shared_ptr<const PreparedImage>> prepared_;
  std::vector<Candidate> candidates_;  // scratch
};

// Both ends of a pair as one number; the same for (u, v) and (v, u).
constexpr std::uint64_t pair_key(VertexId u, VertexId v) {
  const std::uint64_t a = to_index(u), b = to_index(v);
  return a < b ? a << 32 | b : b << 32 | a;
}

}  // namespace mapweld
