// The whole API over loopback, on services whose store a test can reach. Whatever is asked and answered that its
// description (docs/openapi.json) does not say fails the test that asked, by name.
#pragma once

#include <atomic>
#include <chrono>
#include <memory>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <httplib.h>

#include "client/contract/json.h"
#include "server/api/api.h"
#include "server/http/http_server.h"
#include "tests/server/support/services_under_test.h"

namespace mapweld::test {

class DescribedApi;
struct Exchange;

struct Answer {
  int status = 0;
  httplib::Headers headers;
  std::string body;

  contract::Json json() const { return contract::parse_json(body); }
  // Of a problem document; empty for any other answer.
  std::string code() const;
  std::string header(const std::string& name) const;
};

class ApiUnderTest {
 public:
  // `gate` must outlive it; null: everybody is let in.
  explicit ApiUnderTest(const server::HttpOptions& options = {}, const ServicesOptions& services = {},
                        server::Gate* gate = nullptr);
  ~ApiUnderTest();

  ServicesUnderTest& services() { return services_; }
  int port() const { return port_; }
  const std::vector<server::Route>& routes() const { return routes_; }
  bool ready = true;
  std::atomic<std::int64_t> later_s = 0;  // than it is, is the time by which answers are kept

  // Any thread; a connection of its own each.
  Answer ask(const std::string& method, const std::string& path, const httplib::Headers& headers = {},
             const std::string& body = "") const;
  Answer get(const std::string& path) const;
  Answer post(const std::string& path, const std::string& body, const std::string& type = "application/json") const;
  Answer post_image(const std::string& path, const std::string& bytes) const { return post(path, bytes, "image/jpeg"); }
  Answer put(const std::string& path, const std::string& body, const std::string& type) const;
  Answer del(const std::string& path) const;
  // One part an image, file name and bytes.
  Answer post_batch(const std::string& path, const std::vector<std::pair<std::string, std::string>>& images) const;

  // Waits until a merge is at rest, or 30 s.
  contract::Json finished_merge(std::int64_t id);

 private:
  // The answer, once it is what the description says.
  Answer described(Exchange exchange, const httplib::Result& result) const;

  ServicesUnderTest services_;
  server::IdempotencyKeys idempotency_{services_.store(),
                                       [this] { return server::now() + std::chrono::seconds(later_s); }};
  server::Metrics metrics_;
  std::vector<server::Route> routes_;
  std::unique_ptr<DescribedApi> description_;
  std::unique_ptr<server::HttpServer> http_;
  int port_ = 0;
  std::thread thread_;
};

}  // namespace mapweld::test
