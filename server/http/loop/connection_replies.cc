// How a connection sends its replies: whole bodies, streams that are pulled, events as they come.
#include <exception>
#include <functional>
#include <memory>
#include <utility>

#include <boost/asio/post.hpp>
#include <boost/asio/redirect_error.hpp>
#include <boost/asio/use_awaitable.hpp>
#include <spdlog/spdlog.h>

#include "server/http/loop/exchange.h"

namespace mapweld::server {
namespace {

namespace asio = boost::asio;
using asio::awaitable;
using std::chrono::milliseconds;

constexpr std::size_t kSmallBody = 16 * 1024;  // sent together with its head

}  // namespace

awaitable<bool> Connection::send(Exchange& exchange) {
  Reply& reply = *exchange.reply;
  if (reply.stream && state_.streams >= state_.pool.threads()) {
    reply = reply_of("busy", "As many replies are streamed as may be. Try again.", exchange.id());
  }
  ReplyFrame frame{.request_id = exchange.id(),
                   .headers = exchange.plan.admission.headers,
                   .http_1_0 = exchange.head.http_1_0,
                   .close = !exchange.whole || !exchange.head.keep_alive || state_.draining ||
                            requests_ >= state_.options.max_requests_per_connection};
  frame.close = frame.close || ends_by_closing(reply, frame);
  exchange.close = frame.close;
  std::string head = reply_head(reply, frame);
  if (exchange.head.method == "HEAD") {
    if (reply.events) reply.events->end();
    co_return co_await write(head);
  }
  if (reply.stream) {
    if (!co_await write(head)) co_return false;
    ++state_.streams;
    const bool there = co_await send_stream(exchange);
    --state_.streams;
    co_return there;
  }
  if (reply.events) {
    if (!co_await write(head)) co_return false;
    co_return co_await send_events(exchange);
  }
  exchange.bytes_out = reply.body.size();
  if (reply.body.size() <= kSmallBody) {
    head += reply.body;
    co_return co_await write(head);
  }
  if (!co_await write(head)) co_return false;
  co_return co_await write(reply.body);
}

awaitable<bool> Connection::send_stream(Exchange& exchange) {
  const Reply& reply = *exchange.reply;
  const bool in_chunks = !exchange.head.http_1_0 && !reply.stream_bytes;
  bool more = true;
  while (more) {
    std::string piece;
    std::function<bool()> work = [&] { return reply.stream(piece); };
    try {
      more = co_await state_.pool.run<bool>(std::move(work));
    } catch (const std::exception& error) {
      spdlog::error("request {}: the streamed reply broke off: {}", exchange.id(), error.what());
      co_return false;
    }
    exchange.bytes_out += piece.size();
    if (in_chunks) piece = chunk(piece);
    if (!co_await write(piece)) co_return false;
  }
  if (in_chunks && !co_await write(kLastChunk)) co_return false;
  co_return true;
}

awaitable<bool> Connection::send_events(Exchange& exchange) {
  EventStream& events = *exchange.reply->events;
  const auto executor = transport_.socket().get_executor();
  const auto alarm = std::make_shared<asio::steady_timer>(executor);
  next_event_ = alarm;
  events.set_wake([alarm, executor] { asio::post(executor, [alarm] { alarm->cancel(); }); });
  // A client that goes is noticed at once, not only by the next event.
  const auto has_input = std::make_shared<bool>(false);
  transport_.socket().async_wait(Transport::Socket::wait_read,
                                 [alarm, has_input](const boost::system::error_code& error) {
                                   *has_input = !error;
                                   alarm->cancel();
                                 });
  bool there = true;
  while (there && !state_.draining) {
    EventStream::Taken taken = events.take();
    if (!taken.text.empty()) {
      exchange.bytes_out += taken.text.size();
      if (!exchange.head.http_1_0) taken.text = chunk(taken.text);
      there = co_await write(taken.text);
      if (!taken.ended) continue;
    }
    if (taken.ended) break;
    if (*has_input && transport_.is_over()) there = false;
    if (!there) break;
    boost::system::error_code woken;
    alarm->expires_after(milliseconds(state_.options.connection.event_heartbeat_ms));
    co_await alarm->async_wait(asio::redirect_error(asio::use_awaitable, woken));
    if (!woken) events.push(": \n\n");
  }
  events.set_wake({});
  events.end();
  next_event_.reset();
  boost::system::error_code ignored;
  transport_.socket().cancel(ignored);
  if (there && !exchange.head.http_1_0) there = co_await write(kLastChunk);
  co_return there;
}

}  // namespace mapweld::server
