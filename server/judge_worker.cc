#include "server/judge_worker.h"

#include <exception>
#include <optional>
#include <set>

#include <spdlog/spdlog.h>

#include "schema/maps/edge_store.h"
#include "server/maps/loaded_map.h"
#include "server/maps/map_judge.h"
#include "server/maps/map_settings.h"

namespace mapweld::server {
namespace {

constexpr std::size_t kMapsAtOnce = 100;
constexpr int kShareOfACore = 20;  // one in so many

}  // namespace

JudgeWorker::JudgeWorker(Store& store, MapCache& cache, std::size_t memory_bytes, std::chrono::milliseconds interval)
    : store_(store), cache_(cache), memory_bytes_(memory_bytes), interval_(interval), thread_([this] { work(); }) {}

JudgeWorker::~JudgeWorker() { stop(); }

void JudgeWorker::stop() {
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
  }
  wake_.notify_all();
  if (thread_.joinable()) thread_.join();
}

void JudgeWorker::work() {
  std::unique_lock lock(mutex_);
  while (!wake_.wait_for(lock, interval_, [this] { return stopping_; })) {
    lock.unlock();
    try {
      look();
    } catch (const std::exception& error) {
      // Nothing is lost: what is not judged counts as confirmed, and the next look tries again.
      spdlog::warn("judging: {}", error.what());
    }
    lock.lock();
  }
}

void JudgeWorker::look() {
  std::set<MapId> there;
  std::optional<MapId> after;
  for (;;) {
    const std::vector<MapRow> maps = list_maps(store_.read(), kMapsAtOnce, after);
    for (const MapRow& map : maps) {
      there.insert(map.id);
      {
        const std::lock_guard lock(mutex_);
        if (stopping_) return;
      }
      if (map.kind == MapKind::kMap) look_at(map);
    }
    if (maps.size() < kMapsAtOnce) break;
    after = maps.back().id;
  }
  std::erase_if(known_, [&](const auto& known) { return !there.contains(known.first); });
}

void JudgeWorker::look_at(const MapRow& map) {
  const auto [found, is_new] = known_.try_emplace(map.id);
  Known& known = found->second;
  const bool is_quiet = !is_new && known.seen_edges == map.edges;
  known.seen_edges = map.edges;
  // Deleting and restoring images counts as a judgement: edges may be others, though as many.
  if (!is_new && known.judgements != map.judgements) known.judged_edges.reset();
  known.judgements = map.judgements;
  if (is_new && !has_unjudged_edges(store_.read(), map.id)) known.judged_edges = map.edges;
  if (known.judged_edges.value_or(0) == map.edges) return;
  const bool has_grown = map.edges >= known.judged_edges.value_or(0) + known.judged_edges.value_or(0) / 8 + 64;
  const Clock::time_point began = Clock::now();
  if ((!is_quiet && !has_grown) || began < known.not_before) return;
  if (estimated_index_bytes(map.vertices, settings_of(map).parameters.max_features) > memory_bytes_) return;
  const JudgeStatistics judged = judge_map(store_, cache_, map);
  known.judged_edges = judged.edges;
  if (judged.changed > 0) ++known.judgements;
  known.not_before = Clock::now() + kShareOfACore * (Clock::now() - began);
  spdlog::debug("judged the {} edges of {}: {} changed", judged.edges, map.name, judged.changed);
}

}  // namespace mapweld::server
