#include "server/events/event_hub.h"

#include <algorithm>
#include <utility>

#include "client/contract/problem.h"
#include "server/http/wire/text.h"

namespace mapweld::server {
namespace {

constexpr const char* kReset = "event: reset\ndata: {}\n\n";

std::string lines_of(const Event& event, const std::string& id) {
  return (id.empty() ? "" : "id: " + id + "\n") + "event: " + event.type + "\ndata: " + event.data + "\n\n";
}

}  // namespace

EventHub::EventHub(const EventHubOptions& options, Clock clock) : options_(options), clock_(std::move(clock)) {
  // Beyond all numbers of former lives, as long as there were no million events a second.
  next_number_ = static_cast<std::uint64_t>(
      std::chrono::duration_cast<std::chrono::microseconds>(clock_().time_since_epoch()).count());
}

EventHub::~EventHub() { close(); }

void EventHub::tell(Event event) {
  const std::lock_guard lock(mutex_);
  Kept kept{.number = next_number_++, .at = clock_(), .event = nullptr};
  if (event.merge && event.step) {
    const auto [last, first_of_merge] = last_steps_.try_emplace(*event.merge, *event.step);
    kept.bears_step = first_of_merge || last->second != *event.step;
    last->second = *event.step;
  }
  kept.event = std::make_shared<const Event>(std::move(event));
  std::erase_if(listeners_, [&](const Listener& listener) {
    const std::shared_ptr<EventStream> stream = listener.stream.lock();
    return !stream || (hears(listener, *kept.event) && !stream->push(text_of(listener, kept)));
  });
  kept_.push_back(std::move(kept));
  forget_old();
}

std::shared_ptr<EventStream> EventHub::listen(Filter filter, const std::optional<std::int64_t>& merge,
                                              const std::string& last_event_id, const std::vector<Event>& greeting) {
  const std::lock_guard lock(mutex_);
  forget_old();
  std::erase_if(listeners_, [](const Listener& listener) { return listener.stream.expired(); });
  if (listeners_.size() >= options_.max_streams) {
    throw contract::ContractError("busy", "As many event streams are open as may be. Try again.");
  }
  auto stream = std::make_shared<EventStream>();
  Listener listener{stream, merge, std::move(filter)};
  // Something at once, so that a client knows that it is listened to.
  std::string text = ": mapweld\n\n";
  if (last_event_id.empty()) {
    for (const Event& event : greeting) text += lines_of(event, "");
  } else if (const auto begin = after(listener, last_event_id)) {
    for (auto kept = *begin; kept != kept_.end(); ++kept) {
      if (hears(listener, *kept->event)) text += text_of(listener, *kept);
    }
  } else {
    text += kReset;
    for (const Event& event : greeting) text += lines_of(event, "");
  }
  stream->start(std::move(text));
  if (closed_) stream->end();
  listeners_.push_back(std::move(listener));
  return stream;
}

std::size_t EventHub::streams() const {
  const std::lock_guard lock(mutex_);
  return static_cast<std::size_t>(
      std::ranges::count_if(listeners_, [](const Listener& listener) { return !listener.stream.expired(); }));
}

void EventHub::close() {
  const std::lock_guard lock(mutex_);
  closed_ = true;
  for (const Listener& listener : listeners_) {
    if (const auto stream = listener.stream.lock()) stream->end();
  }
  listeners_.clear();
}

std::optional<std::deque<EventHub::Kept>::const_iterator> EventHub::after(const Listener& listener,
                                                                          const std::string& id) const {
  std::uint64_t named = 0;
  if (!parse_whole(id, named, 10)) return std::nullopt;
  const auto found = std::find_if(kept_.rbegin(), kept_.rend(), [&](const Kept& kept) {
    if (!listener.merge) return kept.number == named;
    return kept.bears_step && kept.event->merge == listener.merge && kept.event->step == named;
  });
  if (found == kept_.rend()) return std::nullopt;
  return found.base();
}

bool EventHub::hears(const Listener& listener, const Event& event) {
  if (listener.merge && event.merge != listener.merge) return false;
  return !listener.filter || listener.filter(event);
}

std::string EventHub::text_of(const Listener& listener, const Kept& kept) {
  if (!listener.merge) return lines_of(*kept.event, std::to_string(kept.number));
  return lines_of(*kept.event, kept.bears_step ? std::to_string(*kept.event->step) : "");
}

void EventHub::forget_old() {
  const auto oldest = clock_() - options_.keep_for;
  while (!kept_.empty() && (kept_.size() > options_.keep || kept_.front().at < oldest)) kept_.pop_front();
}

}  // namespace mapweld::server
