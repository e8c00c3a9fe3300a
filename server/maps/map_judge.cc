#include "server/maps/map_judge.h"

#include <algorithm>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "core/guard/guarded_map.h"
#include "schema/maps/edge_store.h"
#include "schema/maps/map_layout.h"
#include "schema/maps/vertex_store.h"

namespace mapweld::server {
namespace {

constexpr std::uint32_t kVerticesAtOnce = 256;

struct Snapshot {
  std::vector<std::shared_ptr<const AppearanceVector>> images;
  std::vector<VerifiedEdge> edges;
};

std::optional<Snapshot> read(Store& store, const MapRow& map) {
  Snapshot snapshot;
  const ReadTransaction db = store.read();
  if (!find_map(db, map.id)) return std::nullopt;
  const MapLayout layout = load_layout(db, map.id);
  snapshot.edges = load_verified_edges(db, layout, {.inter = false});
  for (std::uint32_t from = 0; from < layout.vertices(); from += kVerticesAtOnce) {
    const std::uint32_t count = std::min(kVerticesAtOnce, layout.vertices() - from);
    for (AppearanceVector& image : load_appearances(db, map.id, map.vocabulary, VertexId{from}, count)) {
      snapshot.images.push_back(std::make_shared<const AppearanceVector>(std::move(image)));
    }
  }
  return snapshot;
}

}  // namespace

JudgeStatistics judge_map(Store& store, MapCache& cache, const MapRow& map) {
  const std::optional<Snapshot> read_now = read(store, map);
  if (!read_now) return {};
  const Snapshot& snapshot = *read_now;
  const GuardedMap judged(static_cast<std::uint32_t>(snapshot.images.size()),
                          [&](std::uint32_t v) { return snapshot.images[v]; }, snapshot.edges, {});
  JudgeStatistics statistics;
  statistics.edges = snapshot.edges.size();

  const auto turn = cache.writer_turn(map.id);
  std::vector<JudgedEdge> changed;
  {
    WriteTransaction db = store.write();
    if (!find_map(db, map.id)) return statistics;
    std::map<std::pair<VertexId, VertexId>, EdgeJudgement> written;
    for (JudgedEdge& edge : load_judgements(db, map.id)) {
      written.emplace(std::pair(edge.u, edge.v), std::move(edge.judgement));
    }
    for (std::size_t e = 0; e < snapshot.edges.size(); ++e) {
      const VerifiedEdge& edge = snapshot.edges[e];
      const GuardVerdict& verdict = judged.verdicts()[e];
      EdgeJudgement now{verdict.confidence, verdict.reason, evidence_items(verdict.evidence)};
      const auto before = written.find({edge.u, edge.v});
      if (before != written.end() && before->second != now) changed.push_back({edge.u, edge.v, std::move(now)});
    }
    set_judgements(db, map.id, changed);
    db.commit();
  }
  cache.follow_judgements(map.id, changed);
  statistics.changed = changed.size();
  return statistics;
}

}  // namespace mapweld::server
