#include "server/services/merge_service.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "client/contract/problem.h"
#include "core/mapping/localizer.h"
#include "core/merge/member_table.h"
#include "schema/maps/edge_store.h"
#include "schema/maps/map_layout.h"
#include "schema/maps/map_store.h"
#include "schema/maps/vertex_store.h"
#include "schema/merges/merge_store.h"
#include "server/services/quotas.h"
#include "server/services/times.h"

namespace mapweld::server {
namespace {

using contract::ContractError;

std::optional<std::int64_t> describe(const std::optional<std::uint64_t>& limit) {
  if (!limit) return std::nullopt;
  return static_cast<std::int64_t>(*limit);
}

contract::LargestComponent describe(const LargestComponent& component) {
  return {.vertices = static_cast<std::int64_t>(component.vertices),
          .algebraic_connectivity = component.algebraic_connectivity};
}

contract::EdgeCounts counts_of(std::uint64_t verified, std::uint64_t confirmed) {
  return {.verified = static_cast<std::int64_t>(verified), .confirmed = static_cast<std::int64_t>(confirmed)};
}

contract::MergeParameters describe(const MergeParameters& parameters) {
  contract::MergeParameters out;
  out.min_votes = static_cast<int>(parameters.min_votes);
  out.min_inliers = parameters.min_inliers;
  out.max_false_alarms = parameters.max_false_alarms;
  out.votes = std::string(to_string(parameters.votes));
  out.alias_guard = parameters.alias_guard;
  out.min_confidence = parameters.min_confidence;
  out.serves_certificate = parameters.serves_certificate;
  return out;
}

contract::Merge describe(const MergeStatus& status) {
  contract::Merge merge;
  merge.id = status.id;
  merge.state = to_string(status.state);
  merge.method = status.method;
  merge.maps = status.maps;
  merge.map = status.map;
  merge.seed = static_cast<std::int64_t>(status.seed);
  merge.parameters = describe(status.parameters);
  merge.phase = status.phase;
  merge.step = static_cast<std::int64_t>(status.step);
  merge.words = {static_cast<std::int64_t>(status.words.done), static_cast<std::int64_t>(status.words.total)};
  merge.candidates = {static_cast<std::int64_t>(status.candidates.known),
                      static_cast<std::int64_t>(status.candidates.verified),
                      static_cast<std::int64_t>(status.candidates.accepted)};
  merge.edges = static_cast<std::int64_t>(status.edges);
  merge.edge_counts = counts_of(status.edges, status.confirmed_edges);
  merge.revoked = static_cast<std::int64_t>(status.revoked);
  merge.components = static_cast<std::int64_t>(status.components);
  merge.algebraic_connectivity = status.algebraic_connectivity;
  merge.largest_component = describe(status.largest_component);
  for (const JoinedMember& member : status.joined) {
    merge.joined.push_back({member.map, static_cast<std::int64_t>(member.vertices)});
  }
  merge.independent_joins = static_cast<std::int64_t>(status.independent_joins);
  for (const JoinedPair& pair : status.pairs) {
    merge.pairs.push_back({.maps = {pair.first, pair.second},
                           .verified = static_cast<std::int64_t>(pair.summary.verified),
                           .accepted = static_cast<std::int64_t>(pair.summary.accepted),
                           .confirmed = static_cast<std::int64_t>(pair.summary.confirmed),
                           .edge_counts = counts_of(pair.summary.accepted, pair.summary.confirmed),
                           .independent_joins = pair.summary.independent_joins,
                           .verdict = std::string(to_string(pair.summary.verdict))});
  }
  merge.certified_fraction = status.certified_fraction;
  merge.estimated_fraction = status.estimated_fraction;
  merge.joinable_vertices = describe(status.joinable_vertices);
  merge.elapsed_s = status.elapsed_s;
  merge.budget = status.budget;
  merge.remaining = status.remaining;
  merge.eta_s = status.eta_s;
  if (status.checkpoint) {
    merge.checkpoint = {static_cast<std::int64_t>(status.checkpoint->step), status.checkpoint->age_s};
  }
  merge.stop_reason = status.stop_reason;
  merge.error = status.error;
  merge.created_at = to_rfc3339(status.created_at);
  merge.links = {.self = "/v1/merges/" + std::to_string(status.id), .map = "/v1/maps/" + status.map};
  return merge;
}

contract::CurvePoint describe(const MergeCurvePoint& point) {
  return {.step = static_cast<std::int64_t>(point.step),
          .elapsed_s = point.elapsed_s,
          .verifications = static_cast<std::int64_t>(point.verifications),
          .edges = static_cast<std::int64_t>(point.edges),
          .edge_counts =
              point.confirmed_edges ? std::optional(counts_of(point.edges, *point.confirmed_edges)) : std::nullopt,
          .components = static_cast<std::int64_t>(point.components),
          .algebraic_connectivity = point.algebraic_connectivity,
          .largest_component = describe(point.largest_component),
          .certified_fraction = point.certified_fraction,
          .phase = point.phase};
}

contract::MergeEdge describe(const MergeEdgePoint& edge) {
  return {.u = to_index(edge.u),
          .v = to_index(edge.v),
          .votes = edge.votes,
          .inliers = static_cast<int>(edge.inliers),
          .verifications = static_cast<std::int64_t>(edge.verifications),
          .elapsed_s = edge.elapsed_s,
          .confirmed = edge.confirmed,
          .confidence = edge.confidence,
          .reason = edge.confirmed ? std::nullopt : std::optional(edge.doubt)};
}

// What the edges of a merge are now between each two members. A pair without one is not joined when the merge is
// complete.
std::vector<MemberPairSummary> pairs_of(const Reader& db, const MergeStatus& status) {
  const MergeRow row = find_merge(db, JobId{status.id}).value();
  const MapLayout layout = load_layout(db, row.map);
  std::vector<MergeMember> members;
  for (const MemberRow& member : list_members(db, row.map)) {
    const auto node = std::ranges::find(layout.nodes(), member.map, &LayoutNode::map);
    MergeMember& one = members.emplace_back();
    for (std::uint32_t v = 0; v < member.watermark; ++v) one.vertices.push_back(*node->number(VertexId{v}));
  }
  std::vector<MergeEdge> edges;
  std::vector<bool> confirmed;
  for (const EdgeRow& edge : list_merge_edges(db, row.id, SIZE_MAX >> 1)) {
    MergeEdge& one = edges.emplace_back();
    one.u = edge.u;
    one.v = edge.v;
    confirmed.push_back(edge.confirmed);
  }
  const bool is_complete = row.state == JobState::kCompleted;
  return member_table(members, edges, {}, confirmed,
                      std::vector<bool>(members.size() * (members.size() - 1) / 2, is_complete));
}

template <typename Document, typename Item>
contract::Page<Document> describe(const Page<Item>& page) {
  contract::Page<Document> out;
  for (const Item& item : page.items) out.items.push_back(describe(item));
  out.next_cursor = page.next;
  return out;
}

}  // namespace

// What the status says, and, where images of members went or came back since the checkpoint that it is of, what its
// edges are now.
contract::Merge MergeService::present(const MergeStatus& status) const {
  contract::Merge merge = describe(status);
  if (!status.is_outdated) return merge;
  const contract::Quality quality = quality_.quality(status.map);
  merge.components = quality.components;
  merge.algebraic_connectivity = quality.algebraic_connectivity;
  merge.largest_component = quality.largest_component;
  merge.joined = quality.joined;
  merge.independent_joins = quality.independent_joins;
  merge.certified_fraction.reset();
  merge.estimated_fraction.reset();
  merge.joinable_vertices.reset();
  const std::vector<MemberPairSummary> pairs = pairs_of(store_.read(), status);
  std::uint64_t verified = 0, confirmed = 0;
  for (std::size_t i = 0; i < merge.pairs.size() && i < pairs.size(); ++i) {
    contract::MemberPair& pair = merge.pairs[i];
    verified += pairs[i].accepted;
    confirmed += pairs[i].confirmed;
    pair.accepted = static_cast<std::int64_t>(pairs[i].accepted);
    pair.confirmed = static_cast<std::int64_t>(pairs[i].confirmed);
    pair.edge_counts = counts_of(pairs[i].accepted, pairs[i].confirmed);
    pair.independent_joins = pairs[i].independent_joins;
    pair.verdict = std::string(to_string(pairs[i].verdict));
  }
  merge.edges = static_cast<std::int64_t>(verified);
  merge.edge_counts = counts_of(verified, confirmed);
  merge.candidates.accepted = merge.edges;
  return merge;
}

// By signatures, unless the request says otherwise or a member was made before there were signatures.
VoteRule MergeService::rule_of(const contract::SubmitMerge& request) const {
  if (request.parameters && request.parameters->votes) return *parse_vote_rule(*request.parameters->votes);
  const ReadTransaction db = store_.read();
  for (const std::string& name : request.maps) {
    const std::optional<MapRow> map = find_map(db, name);
    if (map && !has_signatures(db, load_layout(db, map->id), map->vocabulary)) return VoteRule::kMin;
  }
  return VoteRule::kSignatures;
}

contract::Merge MergeService::submit(const contract::SubmitMerge& request, const Caller* caller,
                                     const Keep<contract::Merge>& keep) {
  contract::check(request);
  MergeRequest merge;
  merge.maps = request.maps;
  merge.name = request.name.value_or(contract::default_merge_name(request.maps));
  for (const std::string& member : merge.maps) server::require_use(caller, member);
  server::require_use(caller, merge.name);
  merge.method = request.method.value_or("spectral");  // the best order that there is: docs/evaluation.md
  merge.seed = static_cast<std::uint64_t>(request.seed.value_or(0));
  // Pairs of different maps are judged as pairs of one map are, unless the request says otherwise.
  const MapParameters mapping;
  merge.parameters.min_inliers = mapping.min_inliers;
  merge.parameters.votes = rule_of(request);
  merge.parameters.min_votes = default_min_votes(merge.parameters.votes);
  merge.parameters.alias_guard = merge.method == "spectral";  // the others are as the paper has them
  merge.parameters.serves_certificate = request.budget && request.budget->certified.value_or(false);
  if (request.parameters) {
    const contract::MergeParameters& from = *request.parameters;
    MergeParameters& to = merge.parameters;
    if (from.min_votes) to.min_votes = static_cast<std::uint32_t>(*from.min_votes);
    if (from.min_inliers) to.min_inliers = *from.min_inliers;
    if (from.max_false_alarms) to.max_false_alarms = *from.max_false_alarms;
    if (from.alias_guard) to.alias_guard = *from.alias_guard;
    if (from.min_confidence) to.min_confidence = *from.min_confidence;
    if (from.serves_certificate) to.serves_certificate = *from.serves_certificate;
  }
  if (request.budget) merge.budget = *request.budget;
  return present(jobs_.submit(merge, taken(keep, caller)));
}

void MergeService::require_use(std::int64_t id, const Caller* caller) const {
  if (!sees_all(caller)) server::require_use(caller, jobs_.map_of(id));
}

contract::Merge MergeService::get(std::int64_t id) const { return present(jobs_.get(id)); }

contract::Page<contract::Merge> MergeService::list(const std::optional<std::string>& state, const PageRequest& page,
                                                   const Caller* caller) const {
  std::optional<JobState> wanted;
  if (state) {
    wanted = parse_job_state(*state);
    if (!wanted) throw ContractError("invalid_parameter", "There is no state \"" + *state + "\".");
  }
  std::function<bool(const std::string&)> visible;
  if (!sees_all(caller)) visible = [caller](const std::string& map) { return caller->may_use(map); };
  const Page<MergeStatus> found = jobs_.list(wanted, page.limit, page.cursor, visible);
  contract::Page<contract::Merge> out;
  for (const MergeStatus& status : found.items) {
    try {
      out.items.push_back(present(status));
    } catch (const ContractError& error) {
      if (error.status() != 404) throw;  // it was deleted meanwhile
    }
  }
  out.next_cursor = found.next;
  return out;
}

contract::Page<contract::CurvePoint> MergeService::curve(std::int64_t id, const PageRequest& page) const {
  return describe<contract::CurvePoint>(jobs_.curve(id, page.limit, page.cursor));
}

contract::Page<contract::MergeEdge> MergeService::edges(std::int64_t id, const PageRequest& page) const {
  return describe<contract::MergeEdge>(jobs_.edges(id, page.limit, page.cursor));
}

Keep<MergeStatus> MergeService::presented(const Keep<contract::Merge>& keep) const {
  if (!keep) return {};
  return [this, &keep](WriteTransaction& db, const MergeStatus& status) { keep(db, present(status)); };
}

Keep<MergeStatus> MergeService::taken(const Keep<contract::Merge>& keep, const Caller* caller) const {
  if (caller == nullptr) return presented(keep);
  return [this, &keep, caller](WriteTransaction& db, const MergeStatus& status) {
    take_merge(db, caller, JobId{status.id});
    if (keep) keep(db, present(status));
  };
}

contract::Merge MergeService::pause(std::int64_t id, const Keep<contract::Merge>& keep) {
  return present(jobs_.pause(id, presented(keep)));
}

contract::Merge MergeService::resume(std::int64_t id, const contract::RunMerge& request,
                                     const Keep<contract::Merge>& keep, const Caller* caller) {
  contract::check(request);
  return present(jobs_.resume(id, request.budget, taken(keep, caller)));
}

contract::Merge MergeService::restart(std::int64_t id, const contract::RunMerge& request,
                                      const Keep<contract::Merge>& keep, const Caller* caller) {
  contract::check(request);
  return present(jobs_.restart(id, request.budget, taken(keep, caller)));
}

contract::Merge MergeService::cancel(std::int64_t id, const Keep<contract::Merge>& keep) {
  return present(jobs_.cancel(id, presented(keep)));
}

void MergeService::remove(std::int64_t id) {
  std::optional<MergeRow> merge = find_merge(store_.read(), JobId{id});
  jobs_.remove(id);
  if (merge) opener_.forget(merge->map);
}

}  // namespace mapweld::server
