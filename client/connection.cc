#include "client/connection.h"

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <ctime>
#include <exception>
#include <fstream>
#include <stdexcept>
#include <system_error>

#include <httplib.h>

#include "client/contract/json.h"
#include "client/errors.h"

namespace mapweld::client {
namespace {

bool is_unreserved(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '-' || c == '.' ||
         c == '_' || c == '~';
}

std::string percent_encoded(std::string_view text) {
  constexpr char kHex[] = "0123456789ABCDEF";
  std::string encoded;
  for (const char c : text) {
    if (is_unreserved(c)) {
      encoded += c;
    } else {
      const auto byte = static_cast<unsigned char>(c);
      encoded += {'%', kHex[byte >> 4U], kHex[byte & 15U]};
    }
  }
  return encoded;
}

struct Url {
  std::string origin;  // scheme://host:port
  std::string prefix;  // "" or "/path"
};

Url parse_url(const std::string& text) {
  const auto scheme_end = text.find("://");
  const std::string scheme = scheme_end == std::string::npos ? "http" : text.substr(0, scheme_end);
  const std::string rest = scheme_end == std::string::npos ? text : text.substr(scheme_end + 3);
  const auto path = rest.find('/');
  std::string host = rest.substr(0, path);
  std::string prefix = path == std::string::npos ? "" : rest.substr(path);
  while (!prefix.empty() && prefix.back() == '/') prefix.pop_back();
  const auto bad = [&](const std::string& why) {
    return std::invalid_argument("\"" + text + "\" is not a server's address: " + why +
                                 ". It looks like http://127.0.0.1:8080.");
  };
  if (scheme != "http" && scheme != "https") throw bad("its scheme is neither http nor https");
  const auto colon = host.rfind(':');
  const bool has_port = colon != std::string::npos && host.find(']', colon) == std::string::npos;
  if (host.substr(0, has_port ? colon : host.size()).empty()) throw bad("it has no host");
  if (host.find_first_of(" \t@?#\"<>") != std::string::npos || prefix.find_first_of(" \t?#") != std::string::npos) {
    throw bad("it has a character that does not belong there");
  }
  if (has_port) {
    const std::string port = host.substr(colon + 1);
    if (port.empty() || port.size() > 5 || port.find_first_not_of("0123456789") != std::string::npos ||
        std::stoi(port) < 1 || std::stoi(port) > 65535) {
      throw bad("its port is not 1 to 65535");
    }
  }
  return {scheme + "://" + host, prefix};
}

std::string reason_of(httplib::Error error) {
  switch (error) {
    case httplib::Error::Connection:
      return "nothing answers there. Is mapweld-server running?";
    case httplib::Error::ConnectionTimeout:
      return "the host does not answer in time.";
    case httplib::Error::Read:
      return "the connection broke, or the answer did not come in time.";
    case httplib::Error::Write:
      return "the connection broke while the request was being sent.";
    case httplib::Error::SSLConnection:
      return "TLS could not be agreed on. Is it an https server?";
    case httplib::Error::SSLLoadingCerts:
    case httplib::Error::SSLServerVerification:
      return "its certificate is not trusted.";
    default:
      return httplib::to_string(error) + ".";
  }
}

ServerProblem problem_in(const httplib::Response& response) {
  contract::Problem problem;
  try {
    problem = contract::parse_json(response.body).get<contract::Problem>();
  } catch (const std::exception&) {
    problem = {};
  }
  problem.status = response.status;
  if (problem.title.empty()) problem.title = "HTTP " + std::to_string(response.status);
  if (problem.detail.empty()) problem.detail = problem.title + ".";
  return ServerProblem(problem, std::atof(response.get_header_value("Retry-After").c_str()));
}

}  // namespace

ServerProblem::ServerProblem(contract::Problem problem, double retry_after_s)
    : std::runtime_error(problem.detail), problem_(std::move(problem)), retry_after_s_(retry_after_s) {}

std::string path_of(std::string_view root, const std::vector<std::string>& segments, const Query& query) {
  std::string path(root);
  for (const std::string& segment : segments) {
    path += '/';
    path += percent_encoded(segment);
  }
  char mark = '?';
  for (const auto& [key, value] : query) {
    path += mark;
    path += percent_encoded(key);
    path += '=';
    path += percent_encoded(value);
    mark = '&';
  }
  return path;
}

namespace {

// Keeps SIGPIPE from ending the program when the server closes a connection that is being written to: cpp-httplib
// writes without MSG_NOSIGNAL. Blocks it for this thread and takes away the one that may have come.
class NoSigpipe {
 public:
  NoSigpipe() {
    sigemptyset(&sigpipe_);
    sigaddset(&sigpipe_, SIGPIPE);
    sigset_t pending;
    sigpending(&pending);
    was_pending_ = sigismember(&pending, SIGPIPE) == 1;
    pthread_sigmask(SIG_BLOCK, &sigpipe_, &before_);
  }
  ~NoSigpipe() {
    const timespec at_once{};
    while (!was_pending_ && sigtimedwait(&sigpipe_, nullptr, &at_once) == SIGPIPE) {
    }
    pthread_sigmask(SIG_SETMASK, &before_, nullptr);
  }
  NoSigpipe(const NoSigpipe&) = delete;
  NoSigpipe& operator=(const NoSigpipe&) = delete;

 private:
  sigset_t sigpipe_;
  sigset_t before_;
  bool was_pending_;
};

}  // namespace

struct Connection::Http {
  Http(const std::string& origin, const ConnectionOptions& options) : client(origin) {
    using Seconds = std::chrono::duration<double>;
    client.set_connection_timeout(Seconds(options.connect_timeout_s));
    client.set_read_timeout(Seconds(options.read_timeout_s));
    client.set_write_timeout(Seconds(options.write_timeout_s));
    client.set_keep_alive(true);
    client.set_tcp_nodelay(true);
    client.set_url_encode(false);
    if (!options.key.empty()) client.set_default_headers({{"Authorization", "Bearer " + options.key}});
  }
  httplib::Client client;
};

Connection::Connection(const std::string& base_url, const ConnectionOptions& options) {
  const Url url = parse_url(base_url);
  base_url_ = url.origin + url.prefix;
  prefix_ = url.prefix;
  if (!std::ranges::all_of(options.key, [](char c) { return c > ' ' && c < 0x7F && c != ','; })) {
    throw std::invalid_argument("The key has characters that no key has, a space or a line's end perhaps.");
  }
  http_ = std::make_unique<Http>(url.origin, options);
}
Connection::~Connection() = default;
Connection::Connection(Connection&&) noexcept = default;
Connection& Connection::operator=(Connection&&) noexcept = default;

namespace {

std::string body_of(httplib::Result& result, const std::string& base_url) {
  if (!result) throw ConnectionError("Cannot reach " + base_url + ": " + reason_of(result.error()));
  if (result->status < 200 || result->status > 299) throw problem_in(*result);
  return std::move(result->body);
}

httplib::Headers headers_of(const std::string& idempotency_key) {
  if (idempotency_key.empty()) return {};
  if (!std::ranges::all_of(idempotency_key, [](char c) { return c > ' ' && c < 0x7F; })) {
    throw std::invalid_argument("An idempotency key is of visible ASCII characters.");
  }
  return {{"Idempotency-Key", idempotency_key}};
}

}  // namespace

std::string Connection::get(const std::string& path) {
  const NoSigpipe guard;
  httplib::Result result = http_->client.Get(prefix_ + path);
  return body_of(result, base_url_);
}

std::string Connection::post(const std::string& path, const std::string& body, const std::string& content_type,
                             const std::string& idempotency_key) {
  const NoSigpipe guard;
  httplib::Result result = http_->client.Post(prefix_ + path, headers_of(idempotency_key), body, content_type);
  return body_of(result, base_url_);
}

std::string Connection::post_file(const std::string& path, const std::filesystem::path& file,
                                  const std::string& content_type) {
  std::error_code error;
  const std::uintmax_t bytes = std::filesystem::file_size(file, error);
  std::ifstream in(file, std::ios::binary);
  if (!error && !in) error = std::error_code(errno, std::generic_category());
  if (error) throw std::system_error(error, "cannot read " + file.string());
  std::string piece(std::size_t{1} << 16, '\0');
  const NoSigpipe guard;
  httplib::Result result = http_->client.Post(
      prefix_ + path, bytes,
      [&](std::size_t, std::size_t left, httplib::DataSink& sink) {
        in.read(piece.data(), static_cast<std::streamsize>(std::min(left, piece.size())));
        return in.gcount() > 0 && sink.write(piece.data(), static_cast<std::size_t>(in.gcount()));
      },
      content_type);
  return body_of(result, base_url_);
}

std::string Connection::put(const std::string& path, const std::string& body, const std::string& content_type) {
  const NoSigpipe guard;
  httplib::Result result = http_->client.Put(prefix_ + path, body, content_type);
  return body_of(result, base_url_);
}

std::string Connection::patch(const std::string& path, const std::string& body, const std::string& content_type) {
  const NoSigpipe guard;
  httplib::Result result = http_->client.Patch(prefix_ + path, body, content_type);
  return body_of(result, base_url_);
}

std::string Connection::post_form(const std::string& path, const std::vector<FormPart>& parts,
                                  const std::string& idempotency_key) {
  httplib::MultipartFormDataItems items;
  items.reserve(parts.size());
  for (const FormPart& part : parts) items.push_back({part.name, part.bytes, part.file_name, part.content_type});
  const NoSigpipe guard;
  httplib::Result result = http_->client.Post(prefix_ + path, headers_of(idempotency_key), items);
  return body_of(result, base_url_);
}

std::string Connection::remove(const std::string& path) {
  const NoSigpipe guard;
  httplib::Result result = http_->client.Delete(prefix_ + path);
  return body_of(result, base_url_);
}

void Connection::get(const std::string& path, const std::function<void(std::string_view)>& receive) {
  bool good = false;
  std::string refusal;
  std::exception_ptr failure;  // of `receive`; must not run through cpp-httplib
  const NoSigpipe guard;
  httplib::Result result = http_->client.Get(
      prefix_ + path,
      [&](const httplib::Response& response) {
        good = response.status >= 200 && response.status <= 299;
        return true;
      },
      [&](const char* data, std::size_t size) {
        if (!good) {
          refusal.append(data, size);
          return true;
        }
        try {
          receive({data, size});
          return true;
        } catch (...) {
          failure = std::current_exception();
          return false;
        }
      });
  if (failure) std::rethrow_exception(failure);
  if (result && !good) result->body = refusal;
  body_of(result, base_url_);
}

}  // namespace mapweld::client
