// The step interface that every merge method stands behind.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "core/graph/appearance_graph.h"
#include "core/merge/merge_input.h"
#include "core/merge/merge_state.h"

namespace mapweld {

// A merge is one fixed sequence of steps; how it is interrupted, or by how many threads it is watched, does not change
// it. A step is one transition of the state: the votes of one word (or of one image), or one candidate's verification
// or postponement. Where a transition takes long to prepare, steps before it leave the state as it is. Not thread-safe.
//
// What is behind step(): whatever decides the future is in state(). The rest (graph(), the word queue's heap) follows
// from it and from the input, so that make_merger(input, state()) goes on exactly like this one.
class Merger {
 public:
  virtual ~Merger() = default;
  Merger(const Merger&) = delete;
  Merger& operator=(const Merger&) = delete;

  // One transition, or part of what prepares it; at most one verification. Requires !done(). When it throws (an
  // appearance source that cannot read), nothing has changed and it may be tried again.
  virtual void step() = 0;

  bool done() const { return state().phase == MergePhase::kDone; }
  const MergeState& state() const { return state_; }
  // The members' inner edges and the inter edges so far: the merged map, valid at any time.
  const AppearanceGraph& graph() const { return graph_; }
  const MergeInput& input() const { return input_; }
  // Words in the queue altogether, processed ones included; 0 for a method that does not go by words.
  virtual std::uint32_t words_total() const { return 0; }
  // How many candidates there are altogether, where that is known before they have all been found.
  virtual std::optional<std::uint64_t> candidates_total() const { return std::nullopt; }
  // All candidates without a verdict, with their final votes; nothing while there are votes still to be counted.
  virtual std::optional<std::vector<Candidate>> open_candidates() const { return std::nullopt; }
  // Whether all candidates between two members have a verdict: of each pair, as all_member_pairs lists them.
  virtual std::vector<bool> finished_pairs() const;

 protected:
  // At the beginning: the merged graph has the inner edges only.
  explicit Merger(MergeInput input);
  // Takes over a state of the same input and rebuilds what follows from it. Throws FormatError when its parts do not
  // fit together.
  virtual void resume(MergeState state);

  MergeInput input_;
  MergeState state_;
  AppearanceGraph graph_;
  // What a state of the same merge has as its input_fingerprint when a program stored it that searched otherwise.
  std::optional<std::uint64_t> former_fingerprint_;

 private:
  friend std::unique_ptr<Merger> make_merger(MergeInput input, MergeState state);
  friend std::unique_ptr<Merger> make_grown_merger(MergeInput input, MergeState before);
};

}  // namespace mapweld
