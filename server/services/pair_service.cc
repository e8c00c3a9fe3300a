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
#include "schema/maps/edge_store.h"
#include "schema/maps/map_layout.h"
#include "schema/maps/map_store.h"
#include "schema/maps/vertex_store.h"
#include "schema/merges/merge_store.h"
#include "server/jobs/merge_job_rows.h"
#include "server/maps/map_settings.h"
#include "server/services/cameras.h"
#include "server/services/map_lookup.h"

namespace mapweld::server {
namespace {

using contract::ContractError;

MergeRow require_merge(const Reader& db, std::int64_t id) {
  if (std::optional<MergeRow> merge = find_merge(db, JobId{id})) return std::move(*merge);
  throw ContractError("no_such_merge", "There is no merge " + std::to_string(id) + ".");
}

void require_pair(const Reader& db, const MapRow& map, const MapLayout& layout, VertexId u, VertexId v) {
  for (const VertexId vertex : {u, v}) require_vertex(db, map, layout, to_index(vertex));
  if (u == v) throw ContractError("invalid_parameter", "A pair is of two vertices.");
}

// Where two vertices first come together: in a plain map, or in a merged one that has them of different members.
struct Meeting {
  MapRow map;
  VertexId u{}, v{};  // numbers of that map, u < v
};

Meeting meeting_of(const Reader& db, const MapLayout& layout, VertexId u, VertexId v) {
  // Those that have both lie within each other, and the tree is in depth-first order: the last is the innermost.
  for (auto node = layout.nodes().rbegin(); node != layout.nodes().rend(); ++node) {
    const std::optional<VertexId> own_u = node->node_vertex(u), own_v = node->node_vertex(v);
    if (own_u && own_v) return {find_map(db, node->map).value(), *own_u, *own_v};
  }
  throw StoreError(StoreErrorKind::kCorrupt, "two vertices of a map come together nowhere");
}

// What the two images were compared by.
struct Rule {
  VoteRule votes = VoteRule::kSignatures;
  std::uint32_t min_votes = 0;
  VerifierOptions verifier;
  double min_confidence = kDefaultMinConfidence;
};

Rule rule_of(const MergeRow& merge) {
  const MergeParameters p = parameters_of(merge);
  return {.votes = p.votes,
          .min_votes = p.min_votes,
          .verifier = {.min_inliers = p.min_inliers, .max_false_alarms = p.max_false_alarms},
          .min_confidence = p.min_confidence};
}

Rule rule_of(const MapRow& map) {
  const MapParameters p = settings_of(map).parameters;
  return {.votes = p.votes, .min_votes = p.min_votes, .verifier = {.min_inliers = p.min_inliers}};
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

void add_edge(contract::Pair& pair, const EdgeRow& edge, const EdgeEvidence& evidence, double min_confidence) {
  pair.verdict = "accepted";
  pair.matches = evidence.verification.matches;
  pair.inliers = evidence.verification.inliers;
  pair.confirmed = edge.confirmed;
  pair.confidence = edge.confidence;
  if (!edge.confirmed) pair.reason = edge.doubt;
  if (!edge.confidence) return;
  pair.min_confidence = min_confidence;
  add_evidence(pair, evidence.made_of);
}

// Of a pair of a merge without an edge.
void add_verdict_of_merge(contract::Pair& pair, const Reader& db, JobId job, const Meeting& at) {
  if (const std::optional<RejectedPair> rejected = find_rejected(db, job, at.u, at.v)) {
    pair.verdict = "rejected";
    pair.matches = rejected->matches;
    pair.inliers = rejected->inliers;
    pair.reason = to_string(rejected->reason);
  } else {
    pair.verdict = "pending";
  }
}

contract::Pair explain(const Reader& db, const MapRow& asked, std::uint32_t a, std::uint32_t b, bool with_matches) {
  const VertexId u{std::min(a, b)};
  const VertexId v{std::max(a, b)};
  const MapLayout layout = load_layout(db, asked.id);
  require_pair(db, asked, layout, u, v);
  const Meeting at = meeting_of(db, layout, u, v);
  const std::optional<MergeRow> merge = find_merge_of(db, at.map.id);
  const Rule rule = merge ? rule_of(*merge) : rule_of(at.map);

  const auto appearances = [&](VertexId vertex) {
    const LeafVertex leaf = layout.leaf(vertex);
    return load_appearances(db, leaf.map, asked.vocabulary, leaf.vertex);
  };
  const AppearanceVector image_u = appearances(u);
  const AppearanceVector image_v = appearances(v);
  const auto add_relative = [&](contract::Pair& to, const Verification& verification) {
    const auto camera = [&](VertexId vertex) {
      const LeafVertex leaf = layout.leaf(vertex);
      return camera_of_image(db, find_vertex(db, leaf.map, leaf.vertex).value());
    };
    to.relative = relative_between(image_u, camera(u), image_v, camera(v), verification);
  };
  contract::Pair pair;
  pair.u = to_index(u);
  pair.v = to_index(v);
  pair.map = at.map.name;
  if (merge) pair.merge = to_index(merge->id);
  pair.votes = pair_votes(image_u, image_v, rule.votes);
  if (const std::optional<EdgeRow> edge = find_own_edge(db, at.map.id, at.u, at.v)) {
    const EdgeEvidence evidence = load_edge_evidence(db, edge->id);
    add_edge(pair, *edge, evidence, rule.min_confidence);
    add_relative(pair, evidence.verification);
    if (with_matches) add_matches(pair, image_u, image_v, evidence.verification);
    return pair;
  }
  const bool is_candidate = pair.votes >= rule.min_votes;
  if (!is_candidate) {
    pair.verdict = "not_candidate";
    pair.reason = to_string(Reason::kNoCandidate);
  } else if (merge) {
    add_verdict_of_merge(pair, db, merge->id, at);
  }
  const bool ask_for_verdict = is_candidate && !merge;
  if (!with_matches && !ask_for_verdict) return pair;
  const Verification now = make_verifier(rule.verifier)->verify(image_u, image_v);
  if (ask_for_verdict) {
    pair.verdict = now.accepted ? "pending" : "rejected";
    pair.matches = now.matches;
    pair.inliers = now.inliers;
    if (!now.accepted) pair.reason = to_string(now.reason);
  }
  if (with_matches) {
    add_matches(pair, image_u, image_v, now);
    add_relative(pair, now);
  }
  return pair;
}

}  // namespace

contract::Pair explain_pair(Store& store, std::int64_t merge, std::uint32_t u, std::uint32_t v, bool with_matches) {
  const ReadTransaction db = store.read();
  return explain(db, find_map(db, require_merge(db, merge).map).value(), u, v, with_matches);
}

contract::Pair explain_pair(Store& store, std::string_view map, std::uint32_t u, std::uint32_t v, bool with_matches) {
  const ReadTransaction db = store.read();
  return explain(db, require_map(db, map), u, v, with_matches);
}

}  // namespace mapweld::server
