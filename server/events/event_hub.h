// What has happened lately, told to everybody who listens (docs/http-api.md, "Events"): kept in memory for those who
// come back.
#pragma once

#include <chrono>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "server/http/event_stream.h"

namespace mapweld::server {

struct Event {
  std::string type;
  std::string data;                        // a JSON object, without line ends
  std::vector<std::string> maps = {};      // whom it concerns: who may not use one of them does not hear of it
  std::optional<std::int64_t> merge = {};  // whose stream tells it too
  std::optional<std::uint64_t> step = {};  // of that merge
};

struct EventHubOptions {
  std::size_t keep = 10'000;  // events
  std::chrono::seconds keep_for{24 * 3600};
  std::size_t max_streams = 256;
};

// Thread-safe. Telling costs a copy for each listener and never waits for one.
//
// Every event has a number, greater than that of any before, those of former lives of the server too. In the stream of
// one merge the id is the step instead: the first event of a step bears it, so that who names the last id that it saw
// misses nothing.
class EventHub {
 public:
  using Clock = std::function<std::chrono::system_clock::time_point()>;
  explicit EventHub(const EventHubOptions& options = {}, Clock clock = std::chrono::system_clock::now);
  ~EventHub();  // ends all streams

  void tell(Event event);

  // Whether an event may be heard; null: every one.
  using Filter = std::function<bool(const Event&)>;
  // The events from now on, of all or of one merge; before them those since `last_event_id`, or a `reset` where that is
  // not known any more; or, when it is empty, `greeting`. Throws ContractError busy for more than max_streams.
  std::shared_ptr<EventStream> listen(Filter filter, const std::optional<std::int64_t>& merge,
                                      const std::string& last_event_id, const std::vector<Event>& greeting = {});

  std::size_t streams() const;  // open ones, but for those that have ended since the last event

  // Ends all streams, and those to come at once.
  void close();

 private:
  struct Kept {
    std::uint64_t number = 0;
    std::chrono::system_clock::time_point at;
    std::shared_ptr<const Event> event;
    bool bears_step = false;  // the first of its step
  };
  struct Listener {
    std::weak_ptr<EventStream> stream;
    std::optional<std::int64_t> merge;
    Filter filter;
  };

  // What follows the event that `id` names; nothing: it is not kept.
  std::optional<std::deque<Kept>::const_iterator> after(const Listener& listener, const std::string& id) const;
  static bool hears(const Listener& listener, const Event& event);
  static std::string text_of(const Listener& listener, const Kept& kept);
  void forget_old();

  const EventHubOptions options_;
  const Clock clock_;
  mutable std::mutex mutex_;
  std::uint64_t next_number_;
  std::deque<Kept> kept_;
  std::vector<Listener> listeners_;
  std::map<std::int64_t, std::uint64_t> last_steps_;  // of merges
  bool closed_ = false;
};

}  // namespace mapweld::server
