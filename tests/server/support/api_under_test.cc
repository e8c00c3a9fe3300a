#include "tests/server/support/api_under_test.h"

#include <chrono>
#include <stdexcept>
#include <utility>

#include <gtest/gtest.h>

#include "tests/server/support/described_api.h"

namespace mapweld::test {
namespace {

Answer answer_of(const httplib::Result& result) {
  if (!result) throw std::runtime_error("no answer: " + to_string(result.error()));
  return {result->status, result->headers, result->body};
}

httplib::Client connect(int port) {
  httplib::Client client("127.0.0.1", port);
  client.set_read_timeout(60);
  return client;
}

}  // namespace

std::string Answer::code() const {
  return header("Content-Type") == "application/problem+json" ? json().value("code", "") : "";
}

std::string Answer::header(const std::string& name) const {
  const auto found = headers.find(name);
  return found == headers.end() ? "" : found->second;
}

ApiUnderTest::ApiUnderTest(const server::HttpOptions& options, const ServicesOptions& services, server::Gate* gate)
    : services_(services) {
  server::HttpOptions any_port = options;
  any_port.port = 0;
  any_port.body_folder = services_.store().file().parent_path();
  server::Router router = server::make_router({.store = services_.store(),
                                               .metrics = metrics_,
                                               .vocabularies = services_.vocabularies(),
                                               .maps = services_.maps(),
                                               .masks = services_.masks(),
                                               .images = services_.images(),
                                               .localization = services_.localization(),
                                               .quality = services_.quality(),
                                               .removals = services_.removals(),
                                               .merges = services_.merges(),
                                               .decoder = services_.decoder(),
                                               .events = services_.events(),
                                               .backups = services_.backups(),
                                               .transfer = services_.transfer(),
                                               .idempotency = idempotency_,
                                               .ready = [this] { return ready; }});
  routes_ = router.routes();
  description_ = std::make_unique<DescribedApi>(routes_);
  http_ = std::make_unique<server::HttpServer>(any_port, std::move(router), metrics_, gate);
  port_ = http_->bind();
  thread_ = std::thread([this] { http_->serve(); });
}

ApiUnderTest::~ApiUnderTest() {
  http_->drain();
  thread_.join();
}

Answer ApiUnderTest::described(Exchange exchange, const httplib::Result& result) const {
  Answer answer = answer_of(result);
  exchange.status = answer.status;
  exchange.type = answer.header("Content-Type");
  exchange.reply = answer.body;
  for (const auto& [name, value] : answer.headers) exchange.headers.push_back(name);
  for (const std::string& what : description_->undescribed(exchange)) {
    ADD_FAILURE() << exchange.method << " " << exchange.path << " -> " << answer.status
                  << ": the description does not say: " << what;
  }
  return answer;
}

Answer ApiUnderTest::ask(const std::string& method, const std::string& path, const httplib::Headers& headers,
                         const std::string& body) const {
  httplib::Request request;
  request.method = method;
  request.path = path;
  request.headers = headers;
  request.body = body;
  return described({.method = method, .path = path, .request = body}, connect(port_).send(request));
}

Answer ApiUnderTest::get(const std::string& path) const {
  return described({.method = "GET", .path = path}, connect(port_).Get(path));
}

Answer ApiUnderTest::post(const std::string& path, const std::string& body, const std::string& type) const {
  return described({.method = "POST", .path = path, .request = body}, connect(port_).Post(path, body, type));
}

Answer ApiUnderTest::put(const std::string& path, const std::string& body, const std::string& type) const {
  return described({.method = "PUT", .path = path, .request = body}, connect(port_).Put(path, body, type));
}

Answer ApiUnderTest::del(const std::string& path) const {
  return described({.method = "DELETE", .path = path}, connect(port_).Delete(path));
}

Answer ApiUnderTest::post_batch(const std::string& path,
                                const std::vector<std::pair<std::string, std::string>>& images) const {
  httplib::MultipartFormDataItems items;
  for (const auto& [name, bytes] : images) items.push_back({"image", bytes, name, "image/jpeg"});
  return described({.method = "POST", .path = path}, connect(port_).Post(path, items));
}

contract::Json ApiUnderTest::finished_merge(std::int64_t id) {
  services_.jobs().wait(id, std::chrono::seconds(30));
  return get("/v1/merges/" + std::to_string(id)).json();
}

}  // namespace mapweld::test
