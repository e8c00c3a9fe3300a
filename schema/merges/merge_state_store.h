// A merge's state, put together from its checkpoint and its inter edges.
//
// A checkpoint is about the images that its members had then, less those that were absent. Its part "absent" says
// which: edges at them are none of its edges, though their rows are kept while the images can be restored. When others
// are absent now, the verdicts of the checkpoint become those of today: an edge of which an image is gone is counted
// among the refused pairs, so that what was verified stays counted, and one whose image is back is an edge again.
#pragma once

#include <optional>

#include "core/merge/merge_state.h"
#include "schema/blobs/merge_state_blob.h"
#include "schema/maps/absent_vertices.h"
#include "schema/store.h"
#include "schema/store_types.h"

namespace mapweld {

// The state of the last checkpoint; none before the first. Throws StoreError: kCorrupt when a part or an edge is
// damaged or missing, kNewerVersion.
std::optional<MergeState> load_merge_state(const Reader& db, JobId job);

struct ResumableState {
  MergeState state;
  bool begins_anew = false;  // other images are absent: nothing of its search is of use
};
// The same, with the verdicts of today, when the vertices `absent` of the merged map are. Throws likewise.
std::optional<ResumableState> load_resumable_state(const Reader& db, JobId job, const VertexSet& absent);

// What the last checkpoint says was absent. `is_outdated`: its edges were purged since, so that its search is of no use
// whatever is absent now.
struct CheckpointedAbsence {
  VertexSet vertices;
  bool is_outdated = false;
  friend bool operator==(const CheckpointedAbsence&, const CheckpointedAbsence&) = default;
};
CheckpointedAbsence load_absence(const Reader& db, JobId job);
// Whether images have been deleted, restored or purged since the last checkpoint of the merge that made `merged`.
bool has_other_absence(const Reader& db, JobId job, MapId merged);

inline constexpr const char* kAbsencePart = "absent";  // of a checkpoint
blobs::MergeStatePart encode_absence(const CheckpointedAbsence& absence);

}  // namespace mapweld
