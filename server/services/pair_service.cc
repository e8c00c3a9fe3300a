#include "server/services/pair_service.h"

#include <algorithm>
#include <optional>
#include <string>
#include <utility>

#include "client/contract/problem.h"
#include "core/geometry/epipolar_verifier.h"
#include "core/guard/guard_evidence.h"
#include "core/retrieval/voting.h"
#include "schema/blobs/merge_state_blob.h"
#include "schema/edge_store.h"
#include "schema/map_layout.h"
#include "schema/map_store.h"
#include "schema/merge_store.h"
#include "schema/vertex_store.h"
#include "server/jobs/merge_job_rows.h"

namespace mapweld::server {
namespace {

using contract::ContractError;

MergeRow require_merge(const Reader& db, std::int64_t id) {
  if (std::optional<MergeRow> merge = find_merge(db, JobId{id})) return std::move(*merge);
  throw ContractError("no_such_merge", "There is no merge " + std::to_string(id) + ".");
}

// The direct member that a vertex of the merged map belongs to.
std::string member_of(const Reader& db, const MapLayout& layout, VertexId vertex) {
  for (const MemberRow& member : list_members(db, layout.map())) {
    const auto node = std::ranges::find(layout.nodes(), member.map, &LayoutNode::map);
    if (node != layout.nodes().end() && node->node_vertex(vertex)) return member.name;
  }
  throw StoreError(StoreErrorKind::kCorrupt, "a vertex of a merged map belongs to no member");
}

void require_inter_pair(const Reader& db, const MergeRow& merge, const MapLayout& layout, VertexId u, VertexId v) {
  for (const VertexId vertex : {u, v}) {
    if (to_index(vertex) < layout.vertices()) continue;
    throw ContractError("no_such_vertex", "The merged map \"" + merge.map_name + "\" has no vertex " +
                                              std::to_string(to_index(vertex)) + ".");
  }
  const std::string member = member_of(db, layout, u);
  if (member != member_of(db, layout, v)) return;
  throw ContractError("invalid_parameter", "Vertices " + std::to_string(to_index(u)) + " and " +
                                               std::to_string(to_index(v)) + " are both of \"" + member +
                                               "\"; a merge compares images of different members.");
}

// The verdict that the last checkpoint has on a refused pair.
std::optional<RejectedPair> find_rejected(const Reader& db, JobId job, VertexId u, VertexId v) {
  for (std::size_t page = 0;; ++page) {
    std::optional<StoredPart> part = load_checkpoint_part(db, job, blobs::rejected_page_name(page));
    if (!part) return std::nullopt;
    for (const RejectedPair& pair : blobs::decode_rejected_page({std::move(part->name), std::move(part->bytes)})) {
      if (std::minmax(pair.source, pair.target) == std::minmax(u, v)) return pair;
    }
  }
}

std::string word_of(GeometryKind kind) {
  switch (kind) {
    case GeometryKind::kFundamental:
      return "fundamental";
    case GeometryKind::kHomography:
      return "homography";
    case GeometryKind::kNone:
      break;
  }
  return "none";
}

contract::ImagePoint point_of(const AppearanceVector& image, std::uint16_t index) {
  const Appearance& appearance = image.appearances.at(index);
  return {.x_px = appearance.x_px, .y_px = appearance.y_px};
}

void add_evidence(contract::Pair& pair, const std::vector<EvidenceItem>& items) {
  pair.evidence.emplace();
  for (const EvidenceItem& item : items) {
    pair.evidence->push_back({.name = item.name,
                              .value = item.value,
                              .weight = item.log_odds,
                              .says = std::string(evidence_says(item.name))});
  }
}

void add_matches(contract::Pair& pair, const AppearanceVector& u, const AppearanceVector& v,
                 const Verification& verification) {
  if (!pair.matches) pair.matches = verification.matches;
  if (!pair.inliers) pair.inliers = verification.inliers;
  pair.kind = word_of(verification.kind);
  pair.log10_false_alarms = verification.log10_false_alarms;
  pair.inlier_matches.emplace();
  for (const auto& [a, b] : verification.inlier_matches) {
    pair.inlier_matches->push_back({.u = point_of(u, a), .v = point_of(v, b)});
  }
}

}  // namespace

contract::Pair explain_pair(Store& store, std::int64_t id, std::uint32_t a, std::uint32_t b, bool with_matches) {
  const VertexId u{std::min(a, b)};
  const VertexId v{std::max(a, b)};
  const ReadTransaction db = store.read();
  const MergeRow merge = require_merge(db, id);
  const MergeParameters parameters = parameters_of(merge);
  const MapLayout layout = load_layout(db, merge.map);
  require_inter_pair(db, merge, layout, u, v);

  const VocabularyId vocabulary = find_map(db, merge.map).value().vocabulary;
  const auto appearances = [&](VertexId vertex) {
    const LeafVertex leaf = layout.leaf(vertex);
    return load_appearances(db, leaf.map, vocabulary, leaf.vertex);
  };
  const AppearanceVector image_u = appearances(u);
  const AppearanceVector image_v = appearances(v);
  contract::Pair pair;
  pair.u = to_index(u);
  pair.v = to_index(v);
  pair.votes = pair_votes(image_u, image_v, parameters.votes);
  if (const std::optional<EdgeRow> edge = find_own_edge(db, merge.map, u, v)) {
    const EdgeEvidence evidence = load_edge_evidence(db, edge->id);
    pair.verdict = "accepted";
    pair.matches = evidence.verification.matches;
    pair.inliers = evidence.verification.inliers;
    pair.confirmed = edge->confirmed;
    pair.confidence = edge->confidence;
    if (!edge->confirmed) pair.reason = edge->doubt;
    if (edge->confidence) add_evidence(pair, evidence.made_of);
    if (with_matches) add_matches(pair, image_u, image_v, evidence.verification);
    return pair;
  }
  if (pair.votes < parameters.min_votes) {
    pair.verdict = "not_candidate";
    pair.reason = to_string(Reason::kNoCandidate);
  } else if (const std::optional<RejectedPair> rejected = find_rejected(db, merge.id, u, v)) {
    pair.verdict = "rejected";
    pair.matches = rejected->matches;
    pair.inliers = rejected->inliers;
    pair.reason = to_string(rejected->reason);
  } else {
    pair.verdict = "pending";
  }
  if (with_matches) {
    const auto verifier =
        make_verifier({.min_inliers = parameters.min_inliers, .max_false_alarms = parameters.max_false_alarms});
    add_matches(pair, image_u, image_v, verifier->verify(image_u, image_v));
  }
  return pair;
}

}  // namespace mapweld::server
