#include "server/http/http_server.h"

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <cstring>
#include <random>
#include <stdexcept>

#include <spdlog/spdlog.h>
#include <sys/socket.h>

#include "server/http/body_budget.h"
#include "server/http/connection_queue.h"
#include "server/http/problem.h"

namespace mapweld::server {
namespace {

using contract::Code;
using contract::ContractError;

constexpr std::size_t kStreamBytes = 64 * 1024;  // pieces in which a streamed body is sent
constexpr int kListenBacklog = 256;              // the library's own is 5

// How long a new connection may keep its thread without a request while others wait; a used one gives it up at once.
constexpr double kFirstRequestPatience_s = 1;

// The connection that this thread serves, and what is to be known of its present request.
struct Current {
  Connection* connection = nullptr;
  std::string request_id;
  std::string path;
  std::string route;  // pattern; empty: none matched
  std::string peer;
  std::string subject;
  Admission admission;
  std::uint64_t bytes_in = 0;
  std::uint64_t bytes_out = 0;
  Stopwatch watch;
};
thread_local Current* current = nullptr;

bool is_request_id(const std::string& id) {
  return !id.empty() && id.size() <= 64 && std::all_of(id.begin(), id.end(), [](unsigned char c) {
    return std::isalnum(c) || c == '-' || c == '_' || c == '.';
  });
}

// The values of a field, joined by ", ".
std::string field_of(const httplib::Request& request, const std::string& name) {
  std::string joined;
  const auto [first, last] = request.headers.equal_range(name);
  for (auto field = first; field != last; ++field) joined += (field == first ? "" : ", ") + field->second;
  return joined;
}

Reply reply_of(Code code, const std::string& detail, const std::string& request_id) {
  return problem_reply(contract::problem_of(code, detail, request_id));
}

void send(httplib::Response& response, Reply reply) {
  response.status = reply.status;
  for (auto& [name, value] : reply.headers) response.set_header(name, value);
  if (current) current->subject = std::move(reply.subject);
  if (!reply.stream) {
    if (current) current->bytes_out = reply.body.size();
    if (reply.status != 204) response.set_content(reply.body, reply.content_type);
    return;
  }
  const std::string request_id = current ? current->request_id : "";
  response.set_chunked_content_provider(
      reply.content_type, [stream = std::move(reply.stream), request_id](std::size_t, httplib::DataSink& sink) {
        try {
          std::string piece;
          stream([&](std::string_view text) {
            piece.append(text);
            if (piece.size() < kStreamBytes) return true;
            const bool sent = sink.write(piece.data(), piece.size());
            if (current) current->bytes_out += piece.size();
            piece.clear();
            return sent;
          });
          if (!piece.empty() && !sink.write(piece.data(), piece.size())) return false;
          if (current) current->bytes_out += piece.size();
          sink.done();
          return true;
        } catch (const std::exception& error) {
          spdlog::error("request {}: the streamed reply broke off: {}", request_id, error.what());
          return false;
        }
      });
}

}  // namespace

class HttpServer::Impl final : public httplib::Server {
 public:
  Impl(const HttpOptions& options, Router router, Metrics& metrics, Gate* gate)
      : options_(options),
        router_(std::move(router)),
        metrics_(metrics),
        gate_(gate),
        bodies_(options.max_bodies_bytes) {
    new_task_queue = [this] { return new ConnectionQueue(options_.threads, options_.max_waiting, crowd_); };
    set_tcp_nodelay(true);
    set_keep_alive_timeout(std::max(1, options_.connection.idle_timeout_ms / 1000));
    set_keep_alive_max_count(static_cast<std::size_t>(options_.max_requests_per_connection));
    // Not SO_REUSEPORT, the library's default: with it two servers share a port without noticing.
    set_socket_options([](socket_t socket) {
      const int yes = 1;
      ::setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof(yes));
    });
    set_pre_routing_handler([this](const httplib::Request& request, httplib::Response& response) {
      handle(request, response);
      return HandlerResponse::Handled;
    });
    set_error_handler(httplib::Server::HandlerWithResponse(
        [this](const httplib::Request&, httplib::Response& response) { return explain(response); }));
    set_post_routing_handler(
        [this](const httplib::Request&, httplib::Response& response) { finish_headers(response); });
    set_logger([this](const httplib::Request& request, const httplib::Response& response) { log(request, response); });
    std::random_device entropy;
    id_prefix_ = (std::uint64_t{entropy()} << 32) | entropy();
  }

  ~Impl() override {
    if (bound_ && !served_) ::close(svr_sock_);
  }

  int bind() {
    errno = 0;
    const int port = options_.port == 0 ? bind_to_any_port(options_.host)
                                        : (bind_to_port(options_.host, options_.port) ? options_.port : -1);
    if (port <= 0) {
      throw std::runtime_error("cannot listen on " + options_.host + " port " + std::to_string(options_.port) + ": " +
                               (errno != 0 ? std::strerror(errno) : "no such address"));
    }
    ::listen(svr_sock_, kListenBacklog);
    bound_ = true;
    return port;
  }

  void serve() {
    if (draining_) return;
    served_ = true;
    listen_after_bind();
  }

  void drain() {
    if (draining_.exchange(true)) return;
    // Wakes accept(). The library's stop() is not used: it also breaks off replies that are being streamed.
    if (bound_) ::shutdown(svr_sock_, SHUT_RDWR);
  }

 private:
  // One connection, on a thread of the pool. The library's own loop is replaced: it reads heads without limits and lets
  // idle connections hold their threads.
  bool process_and_close_socket(socket_t socket) override {
    if (ConnectionQueue::turning_away()) {
      Connection connection(socket, options_.connection, draining_);
      send_plain(connection, reply_of("busy", "All connections are in use. Try again.", next_request_id()));
    } else {
      serve_connection(socket);
    }
    ::shutdown(socket, SHUT_RDWR);
    ::close(socket);
    return true;
  }

  void serve_connection(socket_t socket) {
    Connection connection(socket, options_.connection, draining_);
    Current request;
    current = &request;
    int port = 0;
    std::string peer;
    connection.get_remote_ip_and_port(peer, port);
    for (int served = 0; served < options_.max_requests_per_connection; ++served) {
      const Stopwatch idle;
      const double patience_s = served == 0 ? kFirstRequestPatience_s : 0;
      if (!connection.wait_for_request([&] { return crowd_ > 0 && idle.elapsed_s() >= patience_s; })) break;
      request = Current();
      request.connection = &connection;
      request.request_id = next_request_id();
      request.peer = peer;
      const Connection::Head head = connection.read_head();
      if (head == Connection::Head::kClosed) break;
      if (head != Connection::Head::kComplete) {
        const Reply reply = explain_head(head, request.request_id);
        send_plain(connection, reply);
        request.bytes_out = reply.body.size();
        tell_gate("", reply.status);
        connection.linger();
        break;
      }
      bool closed = false;
      const bool answered = process_request(connection, draining_, closed, nullptr);
      if (answered && !connection.body_consumed()) connection.linger();
      if (!answered || closed || draining_ || !connection.body_consumed()) break;
    }
    current = nullptr;
  }

  static Reply explain_head(Connection::Head head, const std::string& request_id) {
    switch (head) {
      case Connection::Head::kTooLarge:
        return reply_of("headers_too_large", "The request line and header fields are too long.", request_id);
      case Connection::Head::kTimeout:
        return reply_of("request_timeout", "The header fields did not arrive in time.", request_id);
      default:
        return reply_of("malformed_request", "The request is not well-formed HTTP/1.1.", request_id);
    }
  }

  // For replies to what never became a request of the library's.
  static void send_plain(Connection& connection, const Reply& reply) {
    connection.write_all("HTTP/1.1 " + std::to_string(reply.status) + " Error\r\nContent-Type: " + reply.content_type +
                         "\r\nContent-Length: " + std::to_string(reply.body.size()) + "\r\nConnection: close\r\n\r\n" +
                         reply.body);
  }

  void handle(const httplib::Request& request, httplib::Response& response) {
    if (const std::string id = request.get_header_value("X-Request-Id"); is_request_id(id)) current->request_id = id;
    std::size_t reserved = 0;
    Reply reply;
    try {
      reply = answer(request, reserved);
    } catch (...) {
      reply = problem_reply(problem_of(std::current_exception(), current->request_id));
    }
    bodies_.give_back(reserved);
    send(response, std::move(reply));
  }

  Reply answer(const httplib::Request& from, std::size_t& reserved) {
    const std::string_view target = from.target;
    const std::size_t question = std::min(target.find('?'), target.size());
    const std::string path(target.substr(0, question));
    Router::Match match = router_.match(from.method, path);
    current->path = path;
    if (match.route) current->route = match.route->pattern;
    if (gate_) {
      current->admission = gate_->admit(head_of(from, match));
      if (current->admission.reply) return std::move(*current->admission.reply);
    }
    if (!match.route) {
      if (match.allow.empty()) throw ContractError("no_such_path", "There is nothing under " + path + ".");
      Reply reply = reply_of("method_not_allowed", path + " answers " + match.allow + " only.", current->request_id);
      reply.headers.emplace_back("Allow", match.allow);
      return reply;
    }
    const Route& route = *match.route;
    Request request;
    request.method = from.method;
    request.path = path;
    request.parameters = std::move(match.parameters);
    request.query = Query(parse_query(target.substr(std::min(question + 1, target.size()))));
    request.query.refuse_unknown(route.query);
    request.content_type = current->connection->content_type();
    request.request_id = current->request_id;
    request.caller = current->admission.caller;
    read_body(route, request.body, reserved);
    return route.handler(request);
  }

  static RequestHead head_of(const httplib::Request& from, const Router::Match& match) {
    return {.request_id = current->request_id,
            .method = from.method,
            .path = current->path,
            .route = match.route,
            .allow = match.allow,
            .parameters = match.parameters,
            .authorization = field_of(from, "Authorization"),
            .origin = field_of(from, "Origin"),
            .host = field_of(from, "Host"),
            .content_type = current->connection->content_type(),
            .peer = current->peer};
  }

  void tell_gate(const std::string& method, int status) {
    if (!gate_) return;
    gate_->finished({.request_id = current->request_id,
                     .method = method,
                     .path = current->path,
                     .route = current->route,
                     .peer = current->peer,
                     .subject = current->subject,
                     .caller = current->admission.caller,
                     .status = status,
                     .bytes_in = current->bytes_in,
                     .bytes_out = current->bytes_out,
                     .elapsed_s = current->watch.elapsed_s()});
  }

  void read_body(const Route& route, std::string& body, std::size_t& reserved) {
    Connection& connection = *current->connection;
    if (route.body == BodyRule::kNone) return;
    if (!connection.content_encoding().empty()) {
      throw ContractError("unsupported_media_type", "Content-Encoding is not supported: send the bytes as they are.");
    }
    if (connection.framing() == Framing::kNone) {
      if (route.body == BodyRule::kRequired) {
        throw ContractError("length_required", "The request has neither Content-Length nor chunked Transfer-Encoding.");
      }
      return;
    }
    const std::size_t limit =
        route.json_body ? std::min(options_.max_json_bytes, options_.max_body_bytes) : options_.max_body_bytes;
    const auto reserve = [&](std::size_t bytes) {
      if (!bodies_.take(bytes)) return false;
      reserved += bytes;
      return true;
    };
    const Connection::Body outcome = connection.read_body(limit, body, reserve);
    current->bytes_in = body.size();
    switch (outcome) {
      case Connection::Body::kComplete:
        return;
      case Connection::Body::kTooLarge:
        throw ContractError("body_too_large", "The body may have at most " + std::to_string(limit) + " bytes.");
      case Connection::Body::kBusy:
        throw ContractError("busy", "The server holds as many uploads as it can. Try again.");
      case Connection::Body::kTimeout:
        throw ContractError("request_timeout", "The body did not arrive in time.");
      case Connection::Body::kMalformed:
      case Connection::Body::kClosed:
        throw ContractError("malformed_request", "The body breaks off or its chunks are malformed.");
    }
  }

  // Errors that the library found by itself get their problem document here.
  HandlerResponse explain(httplib::Response& response) const {
    if (!response.body.empty() || response.content_provider_) return HandlerResponse::Unhandled;
    const std::string request_id = current ? current->request_id : "";
    const int status = response.status;
    const Code code = status == 414   ? Code("uri_too_long")
                      : status >= 500 ? Code("internal_error")
                                      : "malformed_request";
    Reply reply = reply_of(code, status == 414 ? "The path and query are too long." : "The request is not well-formed.",
                           request_id);
    send(response, std::move(reply));
    return HandlerResponse::Handled;
  }

  void finish_headers(httplib::Response& response) const {
    if (!current) return;
    response.set_header("X-Request-Id", current->request_id);
    for (const auto& [name, value] : current->admission.headers) response.set_header(name, value);
    // What is left of a body would be taken for the next request.
    if (draining_ || !current->connection->body_consumed()) {
      response.headers.erase("Keep-Alive");
      if (!response.has_header("Connection")) response.set_header("Connection", "close");
    }
    if (response.status == 204) response.headers.erase("Content-Length");
  }

  void log(const httplib::Request& request, const httplib::Response& response) {
    if (!current) return;
    const double elapsed_s = current->watch.elapsed_s();
    metrics_.count_request(request.method, current->route.empty() ? "none" : current->route, response.status,
                           elapsed_s);
    log_->log(response.status == 500 || response.status == 507 ? spdlog::level::warn : spdlog::level::debug,
              "{} {} {} {} {:.1f} ms", current->request_id, request.method, request.target, response.status,
              elapsed_s * 1e3);
    tell_gate(request.method, response.status);
  }

  std::string next_request_id() {
    char text[32];
    std::snprintf(text, sizeof(text), "%08x-%06llx", static_cast<unsigned>(id_prefix_),
                  static_cast<unsigned long long>(++requests_));
    return text;
  }

  const HttpOptions options_;
  const Router router_;
  Metrics& metrics_;
  Gate* const gate_;
  const std::shared_ptr<spdlog::logger> log_ = spdlog::default_logger();
  BodyBudget bodies_;
  std::atomic<bool> draining_{false};
  std::atomic<int> crowd_{0};
  bool bound_ = false;
  bool served_ = false;
  std::atomic<std::uint64_t> requests_{0};
  std::uint64_t id_prefix_ = 0;
};

HttpServer::HttpServer(const HttpOptions& options, Router router, Metrics& metrics, Gate* gate)
    : impl_(std::make_unique<Impl>(options, std::move(router), metrics, gate)) {}
HttpServer::~HttpServer() = default;
int HttpServer::bind() { return impl_->bind(); }
void HttpServer::serve() { impl_->serve(); }
void HttpServer::drain() { impl_->drain(); }

}  // namespace mapweld::server
