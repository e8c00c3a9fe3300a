// One HTTP connection to a server: requests go out, answers come back as bytes, problems and broken connections as
// exceptions. Knows HTTP, knows nothing of maps.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace mapweld::client {

struct ConnectionOptions {
  double connect_timeout_s = 5;
  double read_timeout_s = 300;  // a batch of large images on a busy server takes its time
  double write_timeout_s = 60;
  std::string key = {};  // sent as "Authorization: Bearer KEY"; empty: none
};

// A part of a multipart/form-data body.
struct FormPart {
  std::string file_name;  // without " \ %, which servers read in more than one way there
  std::string content_type;
  std::string bytes;
  std::string name = "image";  // of the field
};

// Query parameters, in the order in which they are written.
using Query = std::vector<std::pair<std::string, std::string>>;

// "/v1/maps" + {"a b", "images"} -> "/v1/maps/a%20b/images".
std::string path_of(std::string_view root, const std::vector<std::string>& segments, const Query& query = {});

// The connection is kept alive between requests. One thread at a time; a second thread takes a second connection.
class Connection {
 public:
  // `base_url`: "http://host:8080", "https://host/prefix", "host:8080". Throws std::invalid_argument for anything else,
  // an address that bears a key (user:password@host) among it, and for a key with characters that no key has.
  // Connects with the first request.
  explicit Connection(const std::string& base_url, const ConnectionOptions& options = {});
  ~Connection();
  Connection(Connection&&) noexcept;
  Connection& operator=(Connection&&) noexcept;

  const std::string& base_url() const { return base_url_; }

  // Each returns the body of a 2xx answer. Throws ServerProblem for any other status, ConnectionError for none.
  std::string get(const std::string& path);
  // `idempotency_key`: sent with it, so that it takes effect once however often it is sent; empty: none.
  std::string post(const std::string& path, const std::string& body, const std::string& content_type,
                   const std::string& idempotency_key = {});
  // Posts what is in a file, as much as it has when it is opened, in pieces. Throws std::system_error when it cannot be
  // read.
  std::string post_file(const std::string& path, const std::filesystem::path& file, const std::string& content_type);
  std::string put(const std::string& path, const std::string& body, const std::string& content_type);
  std::string patch(const std::string& path, const std::string& body, const std::string& content_type);
  std::string post_form(const std::string& path, const std::vector<FormPart>& parts,
                        const std::string& idempotency_key = {});
  std::string remove(const std::string& path);

  // Hands the body on in pieces as they arrive, and nothing when the answer is not 2xx. What `receive` throws ends the
  // request and is thrown on.
  void get(const std::string& path, const std::function<void(std::string_view)>& receive);

 private:
  struct Http;
  std::unique_ptr<Http> http_;
  std::string base_url_;
  std::string prefix_;
};

}  // namespace mapweld::client
