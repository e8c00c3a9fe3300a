// One connection of the event loop: its requests, one after the other, from the first byte to the reply's last.
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>  // missing in <boost/asio/awaitable.hpp> of 1.74
#include <vector>

#include <boost/asio/awaitable.hpp>
#include <boost/asio/steady_timer.hpp>

#include "server/http/gate.h"
#include "server/http/http_options.h"
#include "server/http/loop/dispatcher.h"
#include "server/http/loop/request_pool.h"
#include "server/http/loop/transport.h"
#include "server/http/message.h"
#include "server/http/wire/body_budget.h"
#include "server/http/wire/head_parser.h"
#include "server/http/wire/reply_head.h"
#include "server/metrics/metrics.h"

namespace mapweld::server {

// What all connections of a loop share; belongs to its thread.
struct LoopState {
  const HttpOptions& options;
  const Dispatcher& dispatcher;
  RequestPool& pool;
  BodyBudget& bodies;
  Metrics& metrics;
  Gate* gate = nullptr;             // null: nobody wants to know
  std::vector<char> received = {};  // into which everything is received; what is not used at once moves on
  bool draining = false;            // no further requests
  std::size_t streams = 0;          // replies that are being streamed
  std::uint64_t id_prefix = 0;      // of request ids
  std::uint64_t requests = 0;
};

// Everything here runs in the loop's thread, without waiting in it; handlers run in the pool.
class Connection {
 public:
  using Clock = std::chrono::steady_clock;

  // `state` must outlive this.
  Connection(Transport transport, LoopState& state);
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;

  // Serves until the client goes, is given up or may send no more.
  boost::asio::awaitable<void> serve();
  // Answers 503 busy to whatever may come.
  boost::asio::awaitable<void> turn_away();

  // Ends a wait that has lasted too long.
  void expire(Clock::time_point now);
  // Since when it has waited for a request; nothing while it has one.
  std::optional<Clock::time_point> idle_since() const { return idle_since_; }
  // Ends that wait and with it the connection; or, in a loop that drains, an event stream.
  void stop_waiting();

 private:
  enum class Got : std::uint8_t { kData, kEnd, kTimeout };
  struct Exchange;

  // A true means that the client is still there.
  boost::asio::awaitable<bool> serve_request();
  boost::asio::awaitable<bool> wait_for_request();
  boost::asio::awaitable<bool> read_head(Exchange& exchange);
  boost::asio::awaitable<void> read_body(Exchange& exchange);
  boost::asio::awaitable<bool> send(Exchange& exchange);
  boost::asio::awaitable<bool> send_stream(Exchange& exchange);
  boost::asio::awaitable<bool> send_events(Exchange& exchange);
  boost::asio::awaitable<void> linger();
  void refuse_without_memory();
  void tell(const Exchange& exchange) const;

  boost::asio::awaitable<bool> shake_hands();
  // Receives into `input_`, which must be used up or kept before the next wait.
  boost::asio::awaitable<Got> receive(Clock::time_point deadline);
  void keep_input();
  boost::asio::awaitable<bool> write(std::string_view bytes);
  boost::asio::awaitable<bool> wait(Transport::Moved::Then until, Clock::time_point deadline);
  std::string next_request_id();

  Transport transport_;
  LoopState& state_;
  std::string peer_;
  std::string_view input_;  // received, not yet used: in `state_.received` or in `kept_`
  std::string kept_;
  int requests_ = 0;
  bool owes_refusal_ = false;  // a request has begun, nothing has been done for it and nothing answered
  Clock::time_point deadline_ = Clock::time_point::max();
  std::optional<Clock::time_point> idle_since_;
  std::shared_ptr<boost::asio::steady_timer> next_event_;  // while events are sent
};

}  // namespace mapweld::server
