#include "schema/merge_state_store.h"

#include <utility>
#include <vector>

#include "schema/blobs/merge_state_blob.h"
#include "schema/edge_store.h"
#include "schema/merge_store.h"

namespace mapweld {

std::optional<MergeState> load_merge_state(const Reader& db, JobId job) {
  std::vector<StoredPart> stored = load_checkpoint(db, job);
  std::vector<NewEdge> rows = load_merge_edges(db, job);
  if (stored.empty() && rows.empty()) return std::nullopt;
  std::vector<blobs::MergeStatePart> parts;
  for (StoredPart& part : stored) parts.push_back({std::move(part.name), std::move(part.bytes)});
  std::vector<MergeEdge> edges;
  edges.reserve(rows.size());
  for (NewEdge& row : rows) {
    edges.push_back({row.u, row.v, row.votes, std::move(row.verification), row.verifications});
  }
  return blobs::decode_merge_state(parts, std::move(edges));
}

}  // namespace mapweld
