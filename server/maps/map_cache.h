// The maps in use, kept in memory within a bound.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <set>
#include <span>

#include "schema/maps/edge_store.h"
#include "schema/maps/map_store.h"
#include "schema/store.h"
#include "server/maps/loaded_map.h"
#include "server/services/worker_pool.h"

namespace mapweld::server {

// A map of so many vertices is in memory within a tenth of a second or two.
inline constexpr std::uint32_t kMostReadAtOnce = 8'192;

// Thread-safe.
class MapCache {
 public:
  // `store` must outlive this.
  MapCache(Store& store, std::size_t capacity_bytes, std::uint32_t most_read_at_once = kMostReadAtOnce)
      : store_(store), capacity_bytes_(capacity_bytes), most_read_at_once_(most_read_at_once) {}

  // The map in memory, read now if it was not there; null when its index alone is beyond the capacity (a StoredMap
  // serves then). Maps not used for longest make room, those in use stay whatever they take. Whoever asks while the map
  // is being read waits for it. Throws std::out_of_range when the map is gone.
  std::shared_ptr<LoadedMap> open(const MapRow& map, int max_features);

  // The same for who can do with a StoredMap: a map of more than `most_read_at_once` vertices is not waited for. It is
  // read beside, and null until it is there.
  std::shared_ptr<LoadedMap> open_unless_long(const MapRow& map, int max_features);

  // Held while a plain map is written to. Also serves maps that are not in memory.
  std::unique_lock<std::mutex> writer_turn(MapId map);

  // What is thought of a plain map's edges was changed (schema/maps/edge_store.h, set_judgements), and that is
  // committed: the map in memory follows. To be called by whoever has held the map's turn since before the transaction.
  void follow_judgements(MapId map, std::span<const JudgedEdge> edges);

  // A map was deleted, or vertices of it were, or came back; the map's turn is then held since before the transaction.
  // Who still has it open keeps it until done; who opens it next reads it anew.
  void forget(MapId map);

  struct Statistics {
    std::size_t maps = 0;
    std::size_t bytes = 0;
  };
  Statistics statistics() const;

 private:
  struct Entry {
    std::mutex loading;              // guards `map`
    std::shared_ptr<LoadedMap> map;  // null: not read yet
    std::uint64_t last_use = 0;      // guarded by MapCache::mutex_
  };
  void make_room();

  Store& store_;
  const std::size_t capacity_bytes_;
  const std::uint32_t most_read_at_once_;
  mutable std::mutex mutex_;
  std::map<MapId, std::shared_ptr<Entry>> entries_;
  std::map<MapId, std::unique_ptr<std::mutex>> turns_;  // of deleted maps too: somebody may hold one
  std::uint64_t uses_ = 0;
  std::set<MapId> being_read_;  // beside
  WorkerPool reader_{1};
  WorkerPool::Lane reads_{reader_};  // used under `mutex_`; the last member: what it runs uses the others
};

}  // namespace mapweld::server
