// A server with a handful of routes, and raw connections to it.
#pragma once

#include <atomic>
#include <chrono>
#include <fstream>
#include <iterator>
#include <memory>
#include <stdexcept>
#include <string>
#include <string_view>
#include <thread>
#include <utility>

#include <gtest/gtest.h>
#include <httplib.h>

#include "client/contract/json.h"
#include "server/http/files/file_reply.h"
#include "server/http/http_server.h"
#include "tests/server/http/raw_client.h"
#include "tests/support/temp_store.h"

namespace mapweld::server {

using mapweld::test::RawClient;

// The routes show what arrived.
class HttpServerTest : public ::testing::Test {
 protected:
  void start(HttpOptions options = {}) {
    options.port = 0;
    options.body_folder = folder_.path();
    options.allowed_hosts.insert(options.allowed_hosts.end(), {"x", "maps.example"});
    Router router;
    router.add({.method = "GET", .pattern = "/hello", .handler = [](const Request&) { return text("hello"); }});
    router.add({.method = "GET", .pattern = "/at-once", .at_once = true, .handler = [](const Request&) {
                  return text("at once");
                }});
    router.add({.method = "GET", .pattern = "/long", .handler = [](const Request&) {
                  Reply reply = text(std::string(100'000, 'x'));
                  reply.etag = "\"long\"";
                  return reply;
                }});
    router.add({.method = "GET", .pattern = "/picture", .handler = [](const Request&) {
                  Reply reply = text(std::string(2000, 'x'));
                  reply.content_type = "image/png";
                  reply.etag = "\"tag\"";
                  return reply;
                }});
    router.add({.method = "GET", .pattern = "/query", .query = {"a"}, .handler = [](const Request& request) {
                  return text(request.query.text("a").value_or("-"));
                }});
    router.add(
        {.method = "POST", .pattern = "/echo", .body = BodyRule::kRequired, .handler = [](const Request& request) {
           return text(request.body);
         }});
    router.add({.method = "POST",
                .pattern = "/json",
                .body = BodyRule::kRequired,
                .json_body = true,
                .handler = [](const Request& request) { return text(std::to_string(request.body.size())); }});
    router.add(
        {.method = "POST", .pattern = "/maybe", .body = BodyRule::kOptional, .handler = [](const Request& request) {
           return text("[" + request.body + "]");
         }});
    router.add({.method = "POST", .pattern = "/file", .body = BodyRule::kFile, .handler = [](const Request& request) {
                  std::ifstream in(request.body_file->path(), std::ios::binary);
                  const std::string bytes((std::istreambuf_iterator<char>(in)), std::istreambuf_iterator<char>());
                  return text(std::to_string(request.body.size()) + " and " + bytes);
                }});
    router.add({.method = "GET", .pattern = "/file", .handler = [this](const Request& request) {
                  return file_reply(request, std::make_shared<OpenFile>(folder_.path() / "given"), "text/plain",
                                    "\"v1\"");
                }});
    router.add({.method = "GET", .pattern = "/slow", .handler = [this](const Request&) {
                  ++slow_;
                  std::this_thread::sleep_for(std::chrono::milliseconds(300));
                  return text("slow");
                }});
    router.add({.method = "GET", .pattern = "/fail", .handler = [](const Request&) -> Reply {
                  throw std::runtime_error("the secret inside");
                }});
    router.add({.method = "GET", .pattern = "/stream", .handler = [](const Request&) {
                  Reply reply = text("");
                  reply.stream = [i = 0](std::string& piece) mutable {
                    while (piece.size() < 10'000 && i < 50'000) piece += "line " + std::to_string(i++) + "\n";
                    return i < 50'000;
                  };
                  return reply;
                }});
    router.add({.method = "GET", .pattern = "/endless", .handler = [this](const Request&) {
                  Reply reply = text("");
                  reply.stream = [this](std::string& piece) {
                    ++pieces_;
                    piece.assign(64'000, 'x');
                    return true;
                  };
                  return reply;
                }});
    router.add({.method = "GET", .pattern = "/events", .handler = [this](const Request& request) {
                  Reply reply;
                  reply.content_type = "text/event-stream";
                  reply.events = events_;
                  events_->start("last id " + request.last_event_id + ".\n");
                  return reply;
                }});
    router.add({.method = "GET", .pattern = "/broken-stream", .handler = [](const Request&) {
                  Reply reply = text("");
                  reply.stream = [first = true](std::string& piece) mutable {
                    if (!std::exchange(first, false)) throw std::runtime_error("the disk went away");
                    piece.assign(100'000, 'x');
                    return true;
                  };
                  return reply;
                }});
    server_ = std::make_unique<HttpServer>(options, std::move(router), metrics_, gate_);
    port_ = server_->bind();
    thread_ = std::thread([this] { server_->serve(); });
  }

  void TearDown() override { stop(); }

  void stop() {
    if (!thread_.joinable()) return;
    server_->drain();
    thread_.join();
  }

  static Reply text(const std::string& body) {
    Reply reply;
    reply.content_type = "text/plain";
    reply.body = body;
    return reply;
  }

  httplib::Client client() const {
    httplib::Client client("127.0.0.1", port_);
    client.set_keep_alive(true);
    return client;
  }

  // Sends `bytes` on a connection of its own.
  std::string exchange(std::string_view bytes) const {
    RawClient raw(port_);
    raw.send(bytes);
    return raw.receive();
  }

  static std::string code(const std::string& reply) {
    const std::size_t body = reply.find("\r\n\r\n");
    if (body == std::string::npos) return "no reply";
    return contract::parse_json(reply.substr(body + 4)).value("code", "");
  }

  const test::TempFolder folder_;
  Metrics metrics_;
  Gate* gate_ = nullptr;  // set before start()
  std::shared_ptr<EventStream> events_ = std::make_shared<EventStream>();
  std::atomic<int> slow_{0};    // calls of /slow
  std::atomic<int> pieces_{0};  // of /endless
  std::unique_ptr<HttpServer> server_;
  int port_ = 0;
  std::thread thread_;
};

}  // namespace mapweld::server
