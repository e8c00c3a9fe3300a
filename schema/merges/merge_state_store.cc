#include "schema/merges/merge_state_store.h"

#include <algorithm>
#include <set>
#include <utility>
#include <vector>

#include "schema/blobs/merge_state_content.h"
#include "schema/maps/edge_store.h"
#include "schema/maps/map_layout.h"
#include "schema/merges/merge_store.h"

namespace mapweld {
namespace {

using Pair = std::pair<VertexId, VertexId>;  // the lesser first

bool touches(const VertexSet& vertices, VertexId u, VertexId v) { return vertices.contains(u) || vertices.contains(v); }

CheckpointedAbsence decode_absence(const blobs::MergeStatePart& part) {
  blobs::MergeStateContentReader content(part);
  CheckpointedAbsence absence;
  absence.is_outdated = content.u8() != 0;
  std::vector<VertexId> vertices;
  std::uint32_t vertex = 0;
  for (std::size_t left = content.count(); left > 0; --left) {
    vertices.push_back(VertexId{vertex += content.varint32()});
  }
  content.finish();
  absence.vertices = VertexSet(std::move(vertices));
  return absence;
}

std::vector<MergeEdge> all_edges(const Reader& db, JobId job) {
  std::vector<MergeEdge> edges;
  for (NewEdge& row : load_merge_edges(db, job)) {
    edges.push_back({row.u, row.v, row.votes, std::move(row.verification), row.verifications});
  }
  return edges;
}

std::vector<MergeEdge> edges_without(std::vector<MergeEdge> edges, const VertexSet& absent) {
  std::erase_if(edges, [&](const MergeEdge& edge) { return touches(absent, edge.u, edge.v); });
  return edges;
}

std::optional<MergeState> decode(const Reader& db, JobId job, std::vector<MergeEdge> edges) {
  std::vector<StoredPart> stored = load_checkpoint(db, job);
  std::erase_if(stored, [](const StoredPart& part) { return part.name == kAbsencePart; });
  if (stored.empty() && edges.empty()) return std::nullopt;
  std::vector<blobs::MergeStatePart> parts;
  for (StoredPart& part : stored) parts.push_back({std::move(part.name), std::move(part.bytes)});
  return blobs::decode_merge_state(parts, std::move(edges));
}

// Gives the state the edges that there are now, of all that were ever found; what else was an edge, or is one again,
// joins or leaves the refused pairs.
void follow(MergeState& state, std::vector<MergeEdge> all, const VertexSet& absent) {
  std::set<Pair> found;
  for (const MergeEdge& edge : all) found.emplace(edge.u, edge.v);
  std::erase_if(state.rejected,
                [&](const RejectedPair& pair) { return found.contains(std::minmax(pair.source, pair.target)); });
  for (const MergeEdge& edge : all) {
    if (touches(absent, edge.u, edge.v))
      state.rejected.push_back({.source = edge.u, .target = edge.v, .votes = edge.votes});
  }
  state.edges = edges_without(std::move(all), absent);
  state.inherited_edges = state.edges.size();
  state.inherited_rejected = state.rejected.size();
}

}  // namespace

std::optional<MergeState> load_merge_state(const Reader& db, JobId job) {
  return decode(db, job, edges_without(all_edges(db, job), load_absence(db, job).vertices));
}

std::optional<ResumableState> load_resumable_state(const Reader& db, JobId job, const VertexSet& absent) {
  const CheckpointedAbsence then = load_absence(db, job);
  std::vector<MergeEdge> all = all_edges(db, job);
  std::optional<MergeState> state = decode(db, job, edges_without(all, then.vertices));
  if (!state) return std::nullopt;
  ResumableState resumable{std::move(*state), then != CheckpointedAbsence{absent}};
  if (resumable.begins_anew) follow(resumable.state, std::move(all), absent);
  return resumable;
}

CheckpointedAbsence load_absence(const Reader& db, JobId job) {
  std::optional<StoredPart> part = load_checkpoint_part(db, job, kAbsencePart);
  if (!part) return {};
  return decode_absence({std::move(part->name), std::move(part->bytes)});
}

bool has_other_absence(const Reader& db, JobId job, MapId merged) {
  return load_absence(db, job) != CheckpointedAbsence{absent_vertices(db, load_layout(db, merged))};
}

blobs::MergeStatePart encode_absence(const CheckpointedAbsence& absence) {
  blobs::MergeStateContent content;
  content.u8(absence.is_outdated ? 1 : 0);
  content.varint(absence.vertices.size());
  std::uint32_t before = 0;
  for (const VertexId vertex : absence.vertices.vertices()) {
    content.varint(to_index(vertex) - before);
    before = to_index(vertex);
  }
  return std::move(content).pack(kAbsencePart);
}

}  // namespace mapweld
