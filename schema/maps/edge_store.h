// Tables `edges` and `verifiers`. A plain map owns its inner edges; a merged map owns its inter edges, each tagged with
// the job that made it, numbered as the merged map numbers its vertices. Edges are read in order of insertion.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/guard/guard_evidence.h"
#include "core/guard/verified_edge.h"
#include "core/types.h"
#include "schema/maps/map_layout.h"
#include "schema/store.h"
#include "schema/store_types.h"

namespace mapweld {

// What is thought of an edge beside what the verifier says.
struct EdgeJudgement {
  std::optional<double> confidence;   // in [0, 1]; none: nobody has judged it, and it is confirmed
  Reason doubt = Reason::kNone;       // kNone: confirmed; otherwise why it is withheld
  std::vector<EvidenceItem> made_of;  // what the confidence is made of
  friend bool operator==(const EdgeJudgement&, const EdgeJudgement&) = default;
};

struct NewEdge {
  VertexId u{};  // u < v
  VertexId v{};
  std::uint32_t votes = 0;
  Verification verification;  // verify(u, v), accepted: geometry and matches go from u to v
  EdgeJudgement judgement = {};
  // Inter edges: how the merge stood when this one was inserted.
  std::uint64_t verifications = 0;
  double elapsed_s = 0;
};

// The id of a verifier's version (PairVerifier::version) and parameters (JSON), stored when it is new.
VerifierId intern_verifier(WriteTransaction& db, std::string_view version, std::string_view parameters);

// Appends edges to a map, in the order given; inter edges when `job` is given. An edge that the map has already is a
// broken request (kConstraint), as is an inner one of a deleted vertex. vertex_store.h and merge_store.h call this;
// both keep the map's counters.
void insert_edges(WriteTransaction& db, MapId map, std::span<const NewEdge> edges, VerifierId verifier,
                  std::optional<JobId> job);

// Takes all its inter edges from a merged map, those of deleted vertices too, whose counters begin again at 0. Its
// revision grows.
void delete_inter_edges(WriteTransaction& db, MapId merged);

struct EdgeRow {
  EdgeId id{};
  VertexId u{};  // u < v, in the numbering of the map that was asked
  VertexId v{};
  bool inter = false;  // made by a merge
  std::uint32_t votes = 0;
  std::uint32_t inliers = 0;
  double log10_false_alarms = 0;
  bool confirmed = true;
  std::optional<double> confidence;  // none: not judged
  std::string doubt;                 // not confirmed: why, a reason of docs/http-api.md
  std::optional<JobId> job;          // inter: the merge that made it
  std::uint64_t verifications = 0;   // inter: as they stood then
  double elapsed_s = 0;              // inter: as it stood then
};

struct EdgeFilter {
  std::uint32_t min_inliers = 0;
  std::optional<bool> inter = {};      // only inter or only inner edges
  std::optional<bool> confirmed = {};  // only confirmed or only unconfirmed edges
};

// Where a list of edges goes on: node of the layout, then the last edge read of it.
struct EdgeCursor {
  std::uint32_t node = 0;
  std::int64_t edge = 0;
  friend bool operator==(const EdgeCursor&, const EdgeCursor&) = default;
};

struct EdgePage {
  std::vector<EdgeRow> edges;
  std::optional<EdgeCursor> next;  // none: that was all
};

// The edges that a map shows, all levels of merging: its own, and those of its members below their watermarks. Node by
// node as in the layout, each in order of insertion.
EdgePage list_edges(const Reader& db, const MapLayout& layout, const EdgeFilter& filter, std::size_t limit,
                    EdgeCursor after = {});

// The inter edges of a merge in order of insertion, those after `after`.
std::vector<EdgeRow> list_merge_edges(const Reader& db, JobId job, std::size_t limit, std::optional<EdgeId> after = {});

// The inter edges of a merge with all their evidence, those of deleted vertices too, in order of insertion: what the
// merge goes on from. Throws StoreError kCorrupt when a blob is damaged.
std::vector<NewEdge> load_merge_edges(const Reader& db, JobId job);

// All edges that a map shows, for building its graph; in the order of list_edges.
std::vector<Edge> load_edges(const Reader& db, const MapLayout& layout, const EdgeFilter& filter = {});

// The same with the matches that each rests on: what a guard judges them by. Throws StoreError kCorrupt when a blob is
// damaged.
std::vector<VerifiedEdge> load_verified_edges(const Reader& db, const MapLayout& layout, const EdgeFilter& filter = {});

// How many there are.
std::uint64_t count_edges(const Reader& db, const MapLayout& layout, const EdgeFilter& filter = {});

// The degrees of the vertices first .. first+count-1 of a map, which it must have: how many confirmed edges each of
// them has, all levels of merging.
std::vector<std::int64_t> count_confirmed_edges_at(const Reader& db, const MapLayout& layout, VertexId first,
                                                   std::uint32_t count);

// The edges at one vertex of a plain or merged map, its own ones only, in order of insertion.
std::vector<EdgeRow> list_own_edges_at(const Reader& db, MapId map, VertexId vertex);
// The edges at one vertex, all levels of merging.
std::vector<EdgeRow> list_edges_at(const Reader& db, const MapLayout& layout, VertexId vertex);

// The edge between two vertices of one map, its own ones only.
std::optional<EdgeRow> find_own_edge(const Reader& db, MapId map, VertexId u, VertexId v);
// The edge between two vertices, all levels of merging: only the map in which both first come together can have it.
std::optional<EdgeRow> find_edge(const Reader& db, const MapLayout& layout, VertexId u, VertexId v);

// Everything that was stored of an edge.
struct EdgeEvidence {
  EdgeRow edge;
  Verification verification;
  std::vector<EvidenceItem> made_of;  // what the confidence is made of; none: not judged, or not written down
  std::string verifier_version;
  std::string verifier_parameters;
};
// Throws std::out_of_range when there is no such edge, StoreError kCorrupt when a blob is damaged.
EdgeEvidence load_edge_evidence(const Reader& db, EdgeId edge);

// What is thought now of an edge.
struct JudgedEdge {
  VertexId u{};  // u < v
  VertexId v{};
  EdgeJudgement judgement = {};
};
// Changes what is thought of a map's own edges, inner ones of a plain map and inter edges of a merged one alike; to be
// called in the transaction that knows it. The map's revision grows, unless there is nothing to change. An edge that
// the map does not have is a broken request (kConstraint), as is a confidence outside of [0, 1], or a doubt without
// one.
void set_judgements(WriteTransaction& db, MapId map, std::span<const JudgedEdge> edges);

// Whether a map has edges of its own that nobody has judged.
bool has_unjudged_edges(const Reader& db, MapId map);

// What is thought of a map's own edges, all of them, in order of insertion.
std::vector<JudgedEdge> load_judgements(const Reader& db, MapId map);

}  // namespace mapweld
