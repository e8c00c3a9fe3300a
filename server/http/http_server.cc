#include "server/http/http_server.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <random>
#include <stdexcept>
#include <thread>
#include <unordered_set>
#include <utility>  // missing in <boost/asio/awaitable.hpp> of 1.74

#include <boost/asio/co_spawn.hpp>
#include <boost/asio/detached.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/redirect_error.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/asio/use_awaitable.hpp>
#include <spdlog/spdlog.h>
#include <sys/resource.h>

#include "server/http/loop/connection.h"
#include "server/http/loop/dispatcher.h"
#include "server/http/loop/memory_reserve.h"
#include "server/http/loop/request_pool.h"
#include "server/http/wire/body_budget.h"

namespace mapweld::server {
namespace {

namespace asio = boost::asio;
using asio::awaitable;
using asio::ip::tcp;
using std::chrono::milliseconds;

constexpr std::size_t kReceiveBytes = 64 * 1024;
constexpr std::size_t kTurnedAwayAtOnce = 64;  // answered 503; more are closed without a word
constexpr milliseconds kSweep{50};             // how late a timeout may be
constexpr milliseconds kAcceptPause{100};      // when there are no descriptors left
constexpr milliseconds kMemoryPause{1};        // when there is no memory; nothing can wait without any

// What the database and files need beside connections.
std::size_t spare_descriptors(const HttpOptions& options) { return 64 + 3 * static_cast<std::size_t>(options.threads); }

std::size_t max_connections(const HttpOptions& options) {
  rlimit limit{};
  if (::getrlimit(RLIMIT_NOFILE, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY) return options.max_connections;
  const std::size_t there = limit.rlim_cur;
  const std::size_t left = std::max(there / 4, there - std::min(there, spare_descriptors(options)));
  if (left < options.max_connections) {
    spdlog::info("at most {} connections: the process may open {} files", left, there);
  }
  return std::min(options.max_connections, left);
}

}  // namespace

class HttpServer::Impl {
 public:
  Impl(const HttpOptions& options, Router router, Metrics& metrics, Gate* gate)
      : options_(options),
        max_connections_(max_connections(options)),
        dispatcher_(options_, std::move(router), gate),
        bodies_(options.max_bodies_bytes),
        pool_(options.threads, options.max_waiting),
        state_{.options = options_,
               .dispatcher = dispatcher_,
               .pool = pool_,
               .bodies = bodies_,
               .metrics = metrics,
               .gate = gate,
               .received = std::vector<char>(kReceiveBytes)} {
    std::random_device entropy;
    state_.id_prefix = entropy();
    tls_ = load_certificate();
  }

  std::size_t connections() const { return open_; }

  int bind() {
    boost::system::error_code error;
    const auto endpoints =
        tcp::resolver(loop_).resolve(options_.host, std::to_string(options_.port), tcp::resolver::passive, error);
    for (const auto& found : endpoints) {
      error = listen(found.endpoint());
      if (!error) return acceptor_.local_endpoint().port();
    }
    throw std::runtime_error("cannot listen on " + options_.host + " port " + std::to_string(options_.port) + ": " +
                             (error ? error.message() : "no such address"));
  }

  void serve() {
    while (!run()) {
    }
    pool_.join();
  }

  void reload_certificate() {
    asio::post(loop_, [this, tls = load_certificate()] { tls_ = tls; });
  }

  void drain() {
    asio::post(loop_, [this] {
      if (std::exchange(state_.draining, true)) return;
      boost::system::error_code ignored;
      acceptor_.close(ignored);
      sweep_timer_.cancel();
      for (Connection* connection : connections_) connection->stop_waiting();
    });
  }

 private:
  std::shared_ptr<const TlsCredentials> load_certificate() const {
    if (options_.tls_certificate.empty() && options_.tls_key.empty()) return nullptr;
    if (options_.tls_certificate.empty() || options_.tls_key.empty()) {
      throw std::runtime_error("TLS needs a certificate and its key");
    }
    return std::make_shared<const TlsCredentials>(options_.tls_certificate, options_.tls_key);
  }

  boost::system::error_code listen(const tcp::endpoint& endpoint) {
    boost::system::error_code error;
    acceptor_.close(error);
    acceptor_.open(endpoint.protocol(), error);
    // Not SO_REUSEPORT: with it two servers share a port without noticing.
    if (!error) acceptor_.set_option(tcp::acceptor::reuse_address(true), error);
    if (!error) acceptor_.bind(endpoint, error);
    if (!error) acceptor_.listen(asio::socket_base::max_listen_connections, error);
    return error;
  }

  // False: something for which there was no memory threw. The connection of which it was is gone, the others go on.
  bool run() {
    try {
      if (!accepts_) asio::co_spawn(loop_, accept(Alive(accepts_)), asio::detached);
      if (!sweeps_) asio::co_spawn(loop_, sweep(Alive(sweeps_)), asio::detached);
      loop_.run();
      return true;
    } catch (const std::exception& error) {
      lacks_memory("the event loop", error);
      return false;
    }
  }

  // Says that a coroutine stands, from when it is made to when it ends, or was lost by what its waiting threw.
  class Alive {
   public:
    explicit Alive(bool& says) : says_(&says) { says = true; }
    Alive(Alive&& other) noexcept : says_(std::exchange(other.says_, nullptr)) {}
    Alive& operator=(Alive&&) = delete;
    ~Alive() {
      if (says_) *says_ = false;
    }

   private:
    bool* says_;
  };

  static void lacks_memory(const char* who, const std::exception& error) {
    spdlog::error("{}: {}", who, error.what());
    std::this_thread::sleep_for(kMemoryPause);
  }

  awaitable<void> accept(Alive) {
    while (!state_.draining) {
      try {
        co_await accept_one();
      } catch (const std::exception& error) {
        lacks_memory("accepting a connection", error);
      }
    }
  }

  awaitable<void> accept_one() {
    boost::system::error_code error;
    tcp::socket socket = co_await acceptor_.async_accept(asio::redirect_error(asio::use_awaitable, error));
    if (!error) {
      asio::co_spawn(loop_, hold(std::move(socket)), asio::detached);
    } else if (!state_.draining) {
      make_room();
      asio::steady_timer pause(loop_, kAcceptPause);
      co_await pause.async_wait(asio::redirect_error(asio::use_awaitable, error));
    }
  }

  // A connection's whole life.
  awaitable<void> hold(tcp::socket socket) {
    const bool room = connections_.size() < max_connections_ || make_room();
    if (!room && (tls_ || connections_.size() >= max_connections_ + kTurnedAwayAtOnce)) co_return;
    Connection connection(Transport(std::move(socket), tls_.get()), state_);
    const Listed listed(*this, connection);
    if (room) {
      co_await connection.serve();
    } else {
      co_await connection.turn_away();
    }
  }

  // While it lives, the connection is among those that are swept.
  class Listed {
   public:
    Listed(Impl& server, Connection& connection) : server_(server), connection_(connection) {
      server_.connections_.insert(&connection_);
      server_.open_ = server_.connections_.size();
      if (server_.connections_.size() == 1) server_.sweep_timer_.cancel();
    }
    ~Listed() {
      server_.connections_.erase(&connection_);
      server_.open_ = server_.connections_.size();
      if (server_.connections_.empty()) server_.sweep_timer_.cancel();
    }
    Listed(const Listed&) = delete;

   private:
    Impl& server_;
    Connection& connection_;
  };

  // Closes the connection that has been idle for longest. False: none is.
  bool make_room() {
    const auto oldest =
        std::min_element(connections_.begin(), connections_.end(), [](const Connection* a, const Connection* b) {
          constexpr auto kNever = Connection::Clock::time_point::max();
          return a->idle_since().value_or(kNever) < b->idle_since().value_or(kNever);
        });
    if (oldest == connections_.end() || !(*oldest)->idle_since()) return false;
    (*oldest)->stop_waiting();
    return true;
  }

  // Gives up those that wait too long. Sleeps while there are no connections.
  awaitable<void> sweep(Alive) {
    while (!state_.draining || !connections_.empty()) {
      try {
        co_await sweep_once();
      } catch (const std::exception& error) {
        lacks_memory("looking for connections that wait too long", error);
      }
    }
  }

  awaitable<void> sweep_once() {
    connections_.empty() ? sweep_timer_.expires_at(Connection::Clock::time_point::max())
                         : sweep_timer_.expires_after(kSweep);
    boost::system::error_code ignored;
    co_await sweep_timer_.async_wait(asio::redirect_error(asio::use_awaitable, ignored));
    MemoryReserve::refill();
    const auto now = Connection::Clock::now();
    for (Connection* connection : connections_) connection->expire(now);
  }

  const MemoryReserve reserve_;
  const HttpOptions options_;
  const std::size_t max_connections_;
  const Dispatcher dispatcher_;
  BodyBudget bodies_;
  asio::io_context loop_{1};
  tcp::acceptor acceptor_{loop_};
  asio::steady_timer sweep_timer_{loop_};
  RequestPool pool_;
  LoopState state_;
  std::shared_ptr<const TlsCredentials> tls_;  // null: none
  std::unordered_set<Connection*> connections_;
  std::atomic<std::size_t> open_{0};  // as many, for other threads
  bool accepts_ = false;  // the coroutines of this name stand
  bool sweeps_ = false;
};

HttpServer::HttpServer(const HttpOptions& options, Router router, Metrics& metrics, Gate* gate)
    : impl_(std::make_unique<Impl>(options, std::move(router), metrics, gate)) {}
HttpServer::~HttpServer() = default;
std::size_t HttpServer::connections() const { return impl_->connections(); }
int HttpServer::bind() { return impl_->bind(); }
void HttpServer::serve() { impl_->serve(); }
void HttpServer::reload_certificate() { impl_->reload_certificate(); }
void HttpServer::drain() { impl_->drain(); }

}  // namespace mapweld::server
