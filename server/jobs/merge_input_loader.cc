#include "server/jobs/merge_input_loader.h"

#include <algorithm>
#include <cstddef>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "core/errors.h"
#include "core/merge/make_merger.h"
#include "schema/maps/edge_store.h"
#include "schema/maps/map_layout.h"
#include "schema/maps/map_store.h"
#include "schema/maps/vertex_store.h"
#include "schema/merges/merge_state_store.h"
#include "server/jobs/merge_job_rows.h"

namespace mapweld::server {
namespace {

constexpr std::uint32_t kVerticesAtOnce = 256;  // between questions whether to stop

const LayoutNode& node_of(const MapLayout& layout, MapId map) {
  const auto found = std::ranges::find(layout.nodes(), map, &LayoutNode::map);
  if (found == layout.nodes().end()) {
    throw StoreError(StoreErrorKind::kCorrupt, "a member is not in the layout of its merged map");
  }
  return *found;
}

MergeMember member_vertices(const LayoutNode& node) {
  MergeMember member;
  member.vertices.reserve(node.watermark);
  for (std::uint32_t v = 0; v < node.watermark; ++v) member.vertices.push_back(*node.number(VertexId{v}));
  return member;
}

// Calls use(filter) for what a merge takes of its members' edges: those inside plain maps, whatever is thought of them
// by now, so that the merge is the same whenever it is loaded; and the confirmed ones between them.
template <typename Use>
void for_each_filter(const Use& use) {
  use(EdgeFilter{.inter = false});
  use(EdgeFilter{.inter = true, .confirmed = true});
}

// Those of a member below its watermark, in the merged numbering: as `load` has them, appended.
template <typename E, typename Load>
void append_inner_edges(const Reader& db, const LayoutNode& node, const Load& load, std::vector<E>& edges) {
  const MapLayout layout = load_layout(db, node.map);
  for_each_filter([&](const EdgeFilter& filter) {
    for (E& edge : load(db, layout, filter)) {
      if (std::max(to_index(edge.u), to_index(edge.v)) >= node.watermark) continue;
      edge.u = *node.number(edge.u);
      edge.v = *node.number(edge.v);
      edges.push_back(std::move(edge));
    }
  });
}

// Leaves those that the guard confirms: the merge rests on them.
void keep_confirmed(std::vector<Edge>& edges, const std::vector<GuardVerdict>& verdicts) {
  std::vector<Edge> kept;
  for (std::size_t e = 0; e < edges.size(); ++e) {
    if (verdicts[e].confirmed()) kept.push_back(edges[e]);
  }
  edges = std::move(kept);
}

// The appearance vectors of all vertices of a map, appended in its own numbering. False when it was told to stop.
bool append_appearances(const Reader& db, const MapLayout& layout, VocabularyId vocabulary,
                        const std::function<bool()>& should_stop,
                        std::vector<std::shared_ptr<const AppearanceVector>>& vectors) {
  const std::size_t base = vectors.size();
  vectors.resize(base + layout.vertices());
  for (const MapLayout::LeafSpan& span : layout.leaf_spans()) {
    for (std::uint32_t from = 0; from < span.count; from += kVerticesAtOnce) {
      if (should_stop()) return false;
      const std::uint32_t count = std::min(kVerticesAtOnce, span.count - from);
      std::vector<AppearanceVector> images =
          load_appearances(db, span.leaf, vocabulary, VertexId{to_index(span.leaf_first) + from}, count);
      for (std::uint32_t i = 0; i < count; ++i) {
        vectors[base + to_index(span.first) + from + i] =
            std::make_shared<const AppearanceVector>(std::move(images[i]));
      }
    }
  }
  return true;
}

// Throws UnusableState where that is damaged.
std::optional<ResumableState> load_state(const Reader& db, JobId job, const VertexSet& absent) {
  try {
    return load_resumable_state(db, job, absent);
  } catch (const StoreError& error) {
    if (error.kind() != StoreErrorKind::kCorrupt) throw;
    throw UnusableState(error.what());
  }
}

}  // namespace

std::optional<LoadedMerge> load_merge(const Reader& db, JobId job, const VerifierFactory& verifier,
                                      const std::function<bool()>& should_stop,
                                      std::shared_ptr<const Executor> executor) {
  std::optional<MergeRow> row = find_merge(db, job);
  if (!row) throw std::out_of_range("there is no merge " + std::to_string(to_index(job)));
  const std::optional<MapRow> map = find_map(db, row->map);
  const MapLayout layout = load_layout(db, row->map);
  const MergeParameters parameters = parameters_of(*row);
  LoadedMerge loaded;
  loaded.absent = absent_vertices(db, layout);
  loaded.input.absent = loaded.absent.vertices();
  std::vector<VerifiedEdge> inner;  // the same edges as in the input
  for (const MemberRow& member : list_members(db, row->map)) {
    const LayoutNode& node = node_of(layout, member.map);
    loaded.input.members.push_back(member_vertices(node));
    append_inner_edges(db, node, load_edges, loaded.input.inner_edges);
    if (parameters.alias_guard) append_inner_edges(db, node, load_verified_edges, inner);
  }
  std::vector<std::shared_ptr<const AppearanceVector>> vectors;
  if (!append_appearances(db, layout, map->vocabulary, should_stop, vectors)) return std::nullopt;
  loaded.input.appearances = std::make_shared<AppearanceTable>(std::move(vectors));
  if (parameters.alias_guard) {
    GuardOptions options;
    options.min_confidence = parameters.min_confidence;
    loaded.guard =
        std::make_shared<AliasGuard>(loaded.input.members, inner, *loaded.input.appearances, options, executor.get());
    keep_confirmed(loaded.input.inner_edges, loaded.guard->inner_verdicts());
    loaded.judgements = load_judgements(db, row->map);
  }
  loaded.input.verifier =
      verifier({.min_inliers = parameters.min_inliers, .max_false_alarms = parameters.max_false_alarms});
  loaded.input.options = {row->method, parameters.min_votes, parameters.votes, row->seed,
                          parameters.serves_certificate};
  loaded.input.executor = std::move(executor);
  if (std::optional<ResumableState> resumable = load_state(db, job, loaded.absent)) {
    loaded.state = std::move(resumable->state);
    loaded.has_other_absence = resumable->begins_anew;
  }
  loaded.row = std::move(*row);
  return loaded;
}

bool begins_anew(const LoadedMerge& loaded) {
  if (loaded.has_other_absence) return true;
  std::size_t vertices = 0;
  for (const MergeMember& member : loaded.input.members) vertices += member.vertices.size();
  return loaded.state && loaded.state->vertices < vertices;
}

std::unique_ptr<Merger> open_merger(LoadedMerge& loaded) {
  if (!loaded.state) return make_merger(std::move(loaded.input));
  const auto open = begins_anew(loaded) ? make_grown_merger
                                        : static_cast<std::unique_ptr<Merger> (*)(MergeInput, MergeState)>(make_merger);
  try {
    return open(std::move(loaded.input), std::move(*loaded.state));
  } catch (const FormatError& error) {
    throw UnusableState(error.what());
  }
}

LoadedMaps load_maps(const Reader& db, std::span<const std::string> names) {
  LoadedMaps loaded;
  std::vector<std::uint32_t> sizes;
  std::vector<std::shared_ptr<const AppearanceVector>> vectors;
  for (const std::string& name : names) {
    std::optional<MapRow> map = find_map(db, name);
    if (!map) throw std::invalid_argument("there is no map named \"" + name + "\"");
    if (!loaded.maps.empty() && map->vocabulary != loaded.maps.front().vocabulary) {
      throw std::invalid_argument("\"" + loaded.maps.front().name + "\" and \"" + name +
                                  "\" have different vocabularies");
    }
    const MapLayout layout = load_layout(db, map->id);
    const auto base = static_cast<std::uint32_t>(vectors.size());
    for (const Edge& edge : load_edges(db, layout, {.min_inliers = 0, .inter = std::nullopt, .confirmed = true})) {
      loaded.input.inner_edges.push_back(
          {VertexId{base + to_index(edge.u)}, VertexId{base + to_index(edge.v)}, edge.weight});
    }
    for_each_filter([&](const EdgeFilter& filter) {
      for (VerifiedEdge& edge : load_verified_edges(db, layout, filter)) {
        loaded.verified_inner_edges.push_back(
            {VertexId{base + to_index(edge.u)}, VertexId{base + to_index(edge.v)}, std::move(edge.inlier_matches)});
      }
    });
    append_appearances(
        db, layout, map->vocabulary, [] { return false; }, vectors);
    sizes.push_back(layout.vertices());
    loaded.maps.push_back(std::move(*map));
  }
  loaded.input.members = number_members(sizes);
  loaded.input.appearances = std::make_shared<AppearanceTable>(std::move(vectors));
  return loaded;
}

}  // namespace mapweld::server
