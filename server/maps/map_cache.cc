#include "server/maps/map_cache.h"

#include <exception>
#include <stdexcept>
#include <vector>

namespace mapweld::server {

std::shared_ptr<LoadedMap> MapCache::open(const MapRow& map, int max_features) {
  std::shared_ptr<Entry> entry;
  {
    const std::lock_guard lock(mutex_);
    auto found = entries_.find(map.id);
    if (found == entries_.end()) {
      if (estimated_index_bytes(map.vertices, max_features) > capacity_bytes_) return nullptr;
      found = entries_.emplace(map.id, std::make_shared<Entry>()).first;
    }
    entry = found->second;
    entry->last_use = ++uses_;
  }
  std::shared_ptr<LoadedMap> loaded;
  {
    const std::lock_guard loading(entry->loading);
    if (!entry->map) {
      // A snapshot of now: the caller's may be older than the last upload.
      const ReadTransaction db = store_.read();
      const std::optional<MapRow> present = find_map(db, map.id);
      if (!present) {
        forget(map.id);
        throw std::out_of_range("the map was deleted");
      }
      entry->map = std::make_shared<LoadedMap>(store_, db, *present);
    }
    loaded = entry->map;
  }
  entry.reset();
  make_room();
  return loaded;
}

std::shared_ptr<LoadedMap> MapCache::open_unless_long(const MapRow& map, int max_features) {
  if (map.vertices <= most_read_at_once_) return open(map, max_features);
  const std::lock_guard lock(mutex_);
  if (const auto found = entries_.find(map.id); found != entries_.end()) {
    const std::unique_lock loading(found->second->loading, std::try_to_lock);
    if (loading && found->second->map) {
      found->second->last_use = ++uses_;
      return found->second->map;
    }
  }
  if (estimated_index_bytes(map.vertices, max_features) > capacity_bytes_) return nullptr;
  if (!being_read_.insert(map.id).second) return nullptr;
  reads_.submit([this, map, max_features] {
    try {
      open(map, max_features);
    } catch (const std::exception&) {
      // Whoever asks for what cannot be read hears of it.
    }
    const std::lock_guard done(mutex_);
    being_read_.erase(map.id);
  });
  return nullptr;
}

void MapCache::make_room() {
  std::vector<std::shared_ptr<LoadedMap>> dropped;  // destroyed after the lock
  const std::lock_guard lock(mutex_);
  while (true) {
    std::size_t bytes = 0;
    auto oldest = entries_.end();
    for (auto it = entries_.begin(); it != entries_.end(); ++it) {
      Entry& entry = *it->second;
      const std::unique_lock loading(entry.loading, std::try_to_lock);
      if (!loading || !entry.map) continue;
      bytes += entry.map->memory_bytes();
      const bool in_use = it->second.use_count() > 1 || entry.map.use_count() > 1;
      if (!in_use && (oldest == entries_.end() || entry.last_use < oldest->second->last_use)) oldest = it;
    }
    if (bytes <= capacity_bytes_) return;
    if (oldest == entries_.end()) break;
    dropped.push_back(std::move(oldest->second->map));
    entries_.erase(oldest);
  }
  // Only maps in use are left.
  for (auto& [id, entry] : entries_) {
    const std::unique_lock loading(entry->loading, std::try_to_lock);
    if (loading && entry->map) entry->map->shed_appearances();
  }
}

std::unique_lock<std::mutex> MapCache::writer_turn(MapId map) {
  std::mutex* turn = nullptr;
  {
    const std::lock_guard lock(mutex_);
    auto& slot = turns_[map];
    if (!slot) slot = std::make_unique<std::mutex>();
    turn = slot.get();
  }
  return std::unique_lock(*turn);
}

void MapCache::follow_judgements(MapId map, std::span<const JudgedEdge> edges) {
  std::shared_ptr<Entry> entry;
  {
    const std::lock_guard lock(mutex_);
    const auto found = entries_.find(map);
    if (found == entries_.end()) return;
    entry = found->second;
  }
  const std::lock_guard loading(entry->loading);
  if (!entry->map) return;
  for (const JudgedEdge& edge : edges) {
    entry->map->set_confirmed(edge.u, edge.v, edge.judgement.doubt == Reason::kNone);
  }
}

void MapCache::forget(MapId map) {
  const std::lock_guard lock(mutex_);
  entries_.erase(map);
}

MapCache::Statistics MapCache::statistics() const {
  Statistics statistics;
  const std::lock_guard lock(mutex_);
  for (const auto& [id, entry] : entries_) {
    const std::unique_lock loading(entry->loading, std::try_to_lock);
    if (!loading || !entry->map) continue;
    ++statistics.maps;
    statistics.bytes += entry->map->memory_bytes();
  }
  return statistics;
}

}  // namespace mapweld::server
