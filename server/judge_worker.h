// Keeps what is thought of the maps' own edges up to date, in the background.
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <map>
#include <mutex>
#include <optional>
#include <thread>

#include "schema/maps/map_store.h"
#include "schema/store.h"
#include "server/maps/map_cache.h"

namespace mapweld::server {

// Judges (server/maps/map_judge.h) each plain map that has edges since it was judged last: when it has stopped growing
// for an interval, or has grown by an eighth; and so seldom that it takes a twentieth of one core at most. Maps that
// were judged before the server started are left alone until they grow. Until it is judged an edge counts as confirmed.
class JudgeWorker {
 public:
  // Both must outlive this. Maps whose index does not fit into the cache are not judged: memory has to hold them.
  JudgeWorker(Store& store, MapCache& cache, std::size_t memory_bytes,
              std::chrono::milliseconds interval = std::chrono::seconds{2});
  ~JudgeWorker();  // stop()
  JudgeWorker(const JudgeWorker&) = delete;
  JudgeWorker& operator=(const JudgeWorker&) = delete;

  // Waits for the map that is being judged. Idempotent.
  void stop();

 private:
  using Clock = std::chrono::steady_clock;
  struct Known {
    std::uint64_t seen_edges = 0;                 // at the last look
    std::optional<std::uint64_t> judged_edges{};  // none: not judged by this server
    std::uint64_t judgements = 0;                 // of the map then
    Clock::time_point not_before{};               // to be judged again
  };
  void work();
  void look();
  void look_at(const MapRow& map);

  Store& store_;
  MapCache& cache_;
  const std::size_t memory_bytes_;
  const std::chrono::milliseconds interval_;
  std::map<MapId, Known> known_;  // of the thread
  std::mutex mutex_;
  std::condition_variable wake_;
  bool stopping_ = false;
  std::thread thread_;
};

}  // namespace mapweld::server
