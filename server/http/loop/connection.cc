#include "server/http/loop/connection.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <exception>

#include <boost/asio/post.hpp>
#include <boost/asio/redirect_error.hpp>
#include <boost/asio/use_awaitable.hpp>
#include <spdlog/spdlog.h>

#include "server/http/loop/exchange.h"
#include "server/http/problem.h"

namespace mapweld::server {
namespace {

namespace asio = boost::asio;
using asio::awaitable;
using std::chrono::milliseconds;
using Clock = Connection::Clock;
using Then = Transport::Moved::Then;

constexpr std::size_t kWriteAtOnce = 256 * 1024;  // then others have their turn

// Until when the next piece must have moved of something that began at `started` and of which `bytes` have moved by
// `now`: neither may it stand still, nor be slow on the whole.
Clock::time_point pace(const ConnectionLimits& limits, Clock::time_point started, std::uint64_t bytes,
                       Clock::time_point now, int still_ms) {
  const auto at_least = milliseconds(bytes * 1000 / std::max<std::uint64_t>(1, limits.min_rate_bytes_per_s));
  return std::min(now + milliseconds(still_ms), started + milliseconds(limits.rate_grace_ms) + at_least);
}

std::string peer_of(const Transport::Socket& socket) {
  boost::system::error_code error;
  const auto endpoint = socket.remote_endpoint(error);
  if (error) return "";
  const asio::ip::address address = endpoint.address();
  const bool mapped = address.is_v6() && address.to_v6().is_v4_mapped();
  return mapped ? asio::ip::make_address_v4(asio::ip::v4_mapped, address.to_v6()).to_string() : address.to_string();
}

// Lets the others in the loop have their turn.
awaitable<void> give_way(Transport::Socket& socket) { co_await asio::post(socket.get_executor(), asio::use_awaitable); }

}  // namespace

Connection::Connection(Transport transport, LoopState& state)
    : transport_(std::move(transport)), state_(state), peer_(peer_of(transport_.socket())) {}

void Connection::expire(Clock::time_point now) {
  if (now < deadline_) return;
  deadline_ = Clock::time_point::max();
  boost::system::error_code ignored;
  transport_.socket().cancel(ignored);
}

void Connection::stop_waiting() {
  if (next_event_) next_event_->cancel();
  if (!idle_since_) return;
  idle_since_.reset();
  expire(Clock::time_point::max());
}

awaitable<void> Connection::serve() {
  try {
    bool there = co_await shake_hands();
    while (there && requests_ < state_.options.max_requests_per_connection) there = co_await serve_request();
  } catch (const std::exception& error) {
    spdlog::error("a connection from {} broke off: {}", peer_, error.what());
    if (owes_refusal_) refuse_without_memory();
  }
}

// Waits for nothing and allocates nothing.
void Connection::refuse_without_memory() {
  std::array<char, 32> id{};
  std::array<char, 256> body{};
  std::array<char, 512> reply{};
  std::snprintf(id.data(), id.size(), "%08x-%06llx", static_cast<unsigned>(state_.id_prefix),
                static_cast<unsigned long long>(state_.requests));
  const int body_bytes =
      std::snprintf(body.data(), body.size(),
                    R"({"type":"urn:mapweld:problem:busy","title":"The server is busy","status":503,)"
                    R"("detail":"The server is short of memory. Try again.","code":"busy","request_id":"%s"})",
                    id.data());
  const int bytes = std::snprintf(reply.data(), reply.size(),
                                  "HTTP/1.1 503 Service Unavailable\r\nContent-Type: application/problem+json\r\n"
                                  "X-Request-Id: %s\r\nRetry-After: 1\r\nConnection: close\r\n"
                                  "Content-Length: %d\r\n\r\n%s",
                                  id.data(), body_bytes, body.data());
  transport_.write({reply.data(), static_cast<std::size_t>(bytes)});
  transport_.end();
  while (transport_.read(state_.received).bytes > 0) {  // what is left unread would take the answer from the client
  }
}

awaitable<void> Connection::turn_away() {
  Exchange exchange{.request_id = next_request_id()};
  exchange.reply = reply_of("busy", "All connections are in use. Try again.", exchange.request_id);
  if (co_await send(exchange)) co_await linger();
}

awaitable<bool> Connection::serve_request() {
  if (input_.empty() && !(co_await wait_for_request())) co_return false;
  ++requests_;
  owes_refusal_ = true;
  Exchange exchange{.request_id = next_request_id()};
  if (!co_await read_head(exchange)) co_return false;
  if (!exchange.reply) {
    exchange.plan = state_.dispatcher.plan(exchange.head, exchange.request_id, peer_);
    exchange.whole = exchange.head.framing == Framing::kNone;
    exchange.reply = std::move(exchange.plan.refusal);
  }
  if (!exchange.reply && exchange.plan.takes_body) co_await read_body(exchange);
  keep_input();
  owes_refusal_ = false;
  if (!exchange.reply && exchange.plan.head.route->at_once) exchange.reply = Dispatcher::answer(exchange.plan);
  if (!exchange.reply && state_.pool.is_full()) {
    exchange.reply = reply_of("busy", "As many requests wait as may. Try again.", exchange.id());
  }
  if (!exchange.reply) {
    std::function<Reply()> work = [&plan = exchange.plan] { return Dispatcher::answer(plan); };
    exchange.reply = co_await state_.pool.run<Reply>(std::move(work));
  }
  exchange.plan.request = {};
  exchange.body.reset();
  const bool there = co_await send(exchange);
  tell(exchange);
  if (there && !exchange.whole) co_await linger();
  co_return there && !exchange.close;
}

// The first bytes of a request wait in `input_` afterwards.
awaitable<bool> Connection::wait_for_request() {
  if (state_.draining) co_return false;
  const auto now = Clock::now();
  idle_since_ = now;
  const Got got = co_await receive(now + milliseconds(state_.options.connection.idle_timeout_ms));
  idle_since_.reset();
  co_return got == Got::kData;
}

awaitable<bool> Connection::read_head(Exchange& exchange) {
  const ConnectionLimits& limits = state_.options.connection;
  const auto deadline = Clock::now() + milliseconds(limits.head_timeout_ms);
  HeadParser parser(limits.max_head_bytes, limits.max_target_bytes);
  while (true) {
    try {
      if (parser.take(input_)) break;
    } catch (...) {
      exchange.reply = problem_reply(problem_of(std::current_exception(), exchange.request_id));
      break;
    }
    const Got got = co_await receive(deadline);
    if (got == Got::kEnd) co_return false;
    if (got == Got::kTimeout) {
      exchange.reply = reply_of("request_timeout", "The header fields did not arrive in time.", exchange.request_id);
      break;
    }
  }
  exchange.head = std::move(parser.head());
  co_return true;
}

awaitable<void> Connection::read_body(Exchange& exchange) {
  const ConnectionLimits& limits = state_.options.connection;
  const auto started = Clock::now();
  try {
    if (exchange.plan.head.route->body == BodyRule::kFile) {
      exchange.plan.request.body_file = std::make_shared<BodyFile>(state_.options.body_folder);
    }
    exchange.body.emplace(exchange.head, exchange.plan.max_body_bytes, state_.bodies,
                          exchange.plan.request.body_file.get());
  } catch (...) {
    exchange.reply = problem_reply(problem_of(std::current_exception(), exchange.id()));
    co_return;
  }
  if (exchange.head.expects_continue && input_.empty()) {
    co_await write("HTTP/1.1 100 Continue\r\n\r\n");  // a client that has gone is noticed below
  }
  while (true) {
    try {
      exchange.whole = exchange.body->take(input_);
    } catch (...) {
      exchange.reply = problem_reply(problem_of(std::current_exception(), exchange.id()));
    }
    exchange.bytes_in = exchange.body->bytes();
    if (exchange.whole || exchange.reply) break;
    co_await give_way(transport_.socket());
    auto deadline = pace(limits, started, exchange.bytes_in, Clock::now(), limits.body_idle_timeout_ms);
    if (!exchange.plan.request.body_file) {
      deadline = std::min(deadline, started + milliseconds(limits.body_timeout_ms));
    }
    const Got got = co_await receive(deadline);
    if (got == Got::kEnd) exchange.reply = reply_of("malformed_request", "The body breaks off.", exchange.id());
    if (got == Got::kTimeout) {
      exchange.reply = reply_of("request_timeout", "The body did not arrive in time.", exchange.id());
    }
    if (got != Got::kData) break;
  }
  if (exchange.whole) exchange.plan.request.body = std::move(exchange.body->body());
}

// Lets the client read the reply before the connection closes: ends our side, then discards what still arrives.
awaitable<void> Connection::linger() {
  transport_.end();
  const auto deadline = Clock::now() + milliseconds(state_.options.connection.linger_ms);
  Got got = Got::kData;
  while (got == Got::kData && Clock::now() < deadline) {
    got = co_await receive(deadline);
    co_await give_way(transport_.socket());
  }
  input_ = {};
}

void Connection::tell(const Exchange& exchange) const {
  const RequestHead& head = exchange.plan.head;
  const std::string route = head.route ? head.route->pattern : "";
  const int status = exchange.reply->status;
  const double elapsed_s = exchange.watch.elapsed_s();
  if (!head.method.empty()) {
    state_.metrics.count_request(head.method, route.empty() ? "none" : route, status, elapsed_s);
  }
  if (!state_.gate) {
    spdlog::log(status == 500 || status == 507 ? spdlog::level::warn : spdlog::level::debug, "{} {} {} {} {:.1f} ms",
                exchange.id(), head.method, exchange.head.target, status, elapsed_s * 1e3);
    return;
  }
  state_.gate->finished({.request_id = exchange.id(),
                         .method = head.method,
                         .path = head.path,
                         .route = route,
                         .role = head.route ? head.route->role : Role::kAnybody,
                         .peer = peer_,
                         .subject = exchange.reply->subject,
                         .caller = exchange.plan.admission.caller,
                         .status = status,
                         .bytes_in = exchange.bytes_in,
                         .bytes_out = exchange.bytes_out,
                         .elapsed_s = elapsed_s});
}

awaitable<bool> Connection::shake_hands() {
  const auto deadline = Clock::now() + milliseconds(state_.options.connection.head_timeout_ms);
  while (true) {
    const Then then = transport_.shake_hands().then;
    if (then == Then::kMore) co_return true;
    if (then == Then::kOver || !co_await wait(then, deadline)) co_return false;
  }
}

awaitable<Connection::Got> Connection::receive(Clock::time_point deadline) {
  while (true) {
    const Transport::Moved moved = transport_.read(state_.received);
    if (moved.bytes > 0) {
      input_ = {state_.received.data(), moved.bytes};
      co_return Got::kData;
    }
    if (moved.then == Then::kOver) co_return Got::kEnd;
    if (!co_await wait(moved.then, deadline)) co_return Got::kTimeout;
  }
}

void Connection::keep_input() {
  if (input_.empty()) {
    kept_ = std::string();
  } else if (input_.data() >= state_.received.data() &&
             input_.data() < state_.received.data() + state_.received.size()) {
    kept_.assign(input_);
    input_ = kept_;
  }
}

awaitable<bool> Connection::write(std::string_view bytes) {
  const ConnectionLimits& limits = state_.options.connection;
  const auto started = Clock::now();
  std::uint64_t written = 0;
  while (!bytes.empty()) {
    const Transport::Moved moved = transport_.write(bytes.substr(0, kWriteAtOnce));
    if (moved.bytes > 0) {
      bytes.remove_prefix(moved.bytes);
      written += moved.bytes;
      if (!bytes.empty()) co_await give_way(transport_.socket());
      continue;
    }
    if (moved.then == Then::kOver) co_return false;
    if (!co_await wait(moved.then, pace(limits, started, written, Clock::now(), limits.write_timeout_ms))) {
      co_return false;
    }
  }
  co_return true;
}

// False: `deadline` has come first.
awaitable<bool> Connection::wait(Then until, Clock::time_point deadline) {
  if (Clock::now() >= deadline) co_return false;
  deadline_ = deadline;
  boost::system::error_code error;
  const auto what = until == Then::kReadable ? Transport::Socket::wait_read : Transport::Socket::wait_write;
  co_await transport_.socket().async_wait(what, asio::redirect_error(asio::use_awaitable, error));
  deadline_ = Clock::time_point::max();
  co_return !error;
}

std::string Connection::next_request_id() {
  char text[32];
  std::snprintf(text, sizeof(text), "%08x-%06llx", static_cast<unsigned>(state_.id_prefix),
                static_cast<unsigned long long>(++state_.requests));
  return text;
}

}  // namespace mapweld::server
