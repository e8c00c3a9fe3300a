// A merge as the store has it: everything that a run needs to begin or to go on, and the merger made of that.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "core/guard/alias_guard.h"
#include "core/merge/merge_input.h"
#include "core/merge/merge_state.h"
#include "core/merge/merger.h"
#include "schema/maps/absent_vertices.h"
#include "schema/maps/map_store.h"
#include "schema/merges/merge_store.h"
#include "schema/store.h"
#include "server/jobs/merge_job_options.h"

namespace mapweld::server {

struct LoadedMerge {
  MergeRow row;
  MergeInput input;
  std::optional<MergeState> state;  // of the last checkpoint, with the verdicts of today; none before the first
  VertexSet absent;                 // those of `input`
  bool has_other_absence = false;   // images have been deleted or restored since the checkpoint
  // Where the merge is guarded: the guard over its members, which input.inner_edges are confirmed by. Refers to
  // input.appearances.
  std::shared_ptr<AliasGuard> guard;
  std::vector<JudgedEdge> judgements;  // guarded: what is written of its edges
};

// What is stored of a merge's state is damaged, or of another merge than its rows: a merge cannot go on from it, and
// has to be restarted.
class UnusableState : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

// Appearances of all members up to their watermarks come into memory. Nothing is returned when `should_stop` says so in
// between. An executor works for the guard here, and for the merger later; null: one thread. Throws UnusableState,
// StoreError for anything else that is damaged, std::out_of_range without such a merge.
std::optional<LoadedMerge> load_merge(const Reader& db, JobId job, const VerifierFactory& verifier,
                                      const std::function<bool()>& should_stop,
                                      std::shared_ptr<const Executor> executor = nullptr);

// Whether members have grown, or images of theirs went or came back, since the state was stored: nothing of its search
// is then of use.
bool begins_anew(const LoadedMerge& loaded);

// The merger that goes on from what was loaded, or begins; takes input and state out of it. Throws UnusableState.
std::unique_ptr<Merger> open_merger(LoadedMerge& loaded);

struct LoadedMaps {
  std::vector<MapRow> maps;  // in the order given
  MergeInput input;          // members, inner edges and appearances; verifier and options are the caller's
  std::vector<VerifiedEdge> verified_inner_edges;  // with what a guard judges them by; those withheld too
};

// Stored maps, plain or merged, as the members of a merge that the store knows nothing of, as they are at this moment.
// Throws std::invalid_argument when a name is unknown or vocabularies differ, StoreError for what is damaged.
LoadedMaps load_maps(const Reader& db, std::span<const std::string> names);

}  // namespace mapweld::server
