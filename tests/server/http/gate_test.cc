#include "server/http/gate.h"

#include <mutex>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "server/http/problem.h"
#include "tests/server/http/http_server_under_test.h"

namespace mapweld::server {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

// Lets in who says "Bearer yes", and remembers all that it was asked and told.
class RecordingGate final : public Gate {
 public:
  Admission admit(const RequestHead& head) override {
    const std::lock_guard lock(mutex_);
    asked.push_back(head);
    Admission admission;
    admission.headers.emplace_back("X-Seen", "by the gate");
    if (head.authorization == "Bearer throw") throw contract::ContractError("busy", "The gate is busy.");
    if (head.authorization != "Bearer yes") {
      admission.reply = problem_reply(contract::problem_of("malformed_request", "Say yes.", head.request_id));
      return admission;
    }
    admission.caller = std::make_shared<Caller>(Caller{.name = "robot-1"});
    return admission;
  }
  void finished(const FinishedRequest& request) noexcept override {
    const std::lock_guard lock(mutex_);
    told.push_back(request);
  }

  std::vector<RequestHead> asked;
  std::vector<FinishedRequest> told;

 private:
  std::mutex mutex_;
};

class GateTest : public HttpServerTest {
 protected:
  void SetUp() override {
    gate_ = &gate;
    start();
  }
  // What the gate was told, once the server has finished with everything.
  const FinishedRequest& told_last() {
    stop();
    return gate.told.at(gate.told.size() - 1);
  }

  RecordingGate gate;
};

TEST_F(GateTest, IsAskedByTheHeadOfARequest) {
  RawClient raw(port_);
  raw.send(
      "POST /echo?x=1 HTTP/1.1\r\nHost: maps.example:80\r\nOrigin: http://a\r\nOrigin: http://b\r\n"
      "Content-Type: text/plain\r\nAuthorization: Bearer no\r\nContent-Length: 3\r\n\r\n");
  EXPECT_THAT(raw.receive(), HasSubstr("Say yes."));
  ASSERT_EQ(gate.asked.size(), 1u);
  const RequestHead& head = gate.asked[0];
  EXPECT_EQ(head.method, "POST");
  EXPECT_EQ(head.path, "/echo");
  ASSERT_NE(head.route, nullptr);
  EXPECT_EQ(head.route->pattern, "/echo");
  EXPECT_EQ(head.authorization, "Bearer no");
  EXPECT_EQ(head.origin, "http://a, http://b");
  EXPECT_EQ(head.host, "maps.example:80");
  EXPECT_EQ(head.content_type, "text/plain");
  EXPECT_EQ(head.peer, "127.0.0.1");
}

TEST_F(GateTest, ARefusalComesBeforeTheBody) {
  RawClient raw(port_);
  raw.send("POST /echo HTTP/1.1\r\nHost: x\r\nContent-Length: 1000000\r\n\r\n");  // of which nothing is sent
  const std::string reply = raw.receive();
  EXPECT_THAT(reply, StartsWith("HTTP/1.1 400"));
  EXPECT_THAT(reply, HasSubstr("X-Seen: by the gate"));
  EXPECT_THAT(reply, HasSubstr("Connection: close"));
}

TEST_F(GateTest, IsAskedForPathsAndMethodsThatDoNotExist) {
  auto http = client();
  EXPECT_EQ(http.Get("/nothing")->status, 400);
  EXPECT_EQ(http.Delete("/hello")->status, 400);
  ASSERT_EQ(gate.asked.size(), 2u);
  EXPECT_EQ(gate.asked[0].route, nullptr);
  EXPECT_EQ(gate.asked[0].allow, "");
  EXPECT_EQ(gate.asked[1].allow, "GET, HEAD, OPTIONS");
}

TEST_F(GateTest, IsToldOfARequestThatItLetIn) {
  auto http = client();
  const auto reply =
      http.Post("/echo", {{"Authorization", "Bearer yes"}, {"X-Request-Id", "mine"}}, "12345", "text/plain");
  EXPECT_EQ(reply->status, 200);
  EXPECT_EQ(reply->get_header_value("X-Seen"), "by the gate");
  const FinishedRequest& request = told_last();
  EXPECT_EQ(request.request_id, "mine");
  EXPECT_EQ(request.method, "POST");
  EXPECT_EQ(request.path, "/echo");
  EXPECT_EQ(request.route, "/echo");
  EXPECT_EQ(request.peer, "127.0.0.1");
  ASSERT_NE(request.caller, nullptr);
  EXPECT_EQ(request.caller->name, "robot-1");
  EXPECT_EQ(request.status, 200);
  EXPECT_EQ(request.bytes_in, 5u);
  EXPECT_EQ(request.bytes_out, 5u);
  EXPECT_GT(request.elapsed_s, 0);
}

TEST_F(GateTest, IsToldOfEveryByteOfAStream) {
  const auto reply = client().Get("/stream", {{"Authorization", "Bearer yes"}});
  EXPECT_EQ(told_last().bytes_out, reply->body.size());
}

TEST_F(GateTest, TheNextRequestOfAConnectionIsNotTakenForTheLastOnesCaller) {
  auto http = client();
  EXPECT_EQ(http.Get("/hello", {{"Authorization", "Bearer yes"}})->status, 200);
  EXPECT_EQ(http.Get("/hello")->status, 400);
  EXPECT_EQ(told_last().caller, nullptr);
}

TEST_F(GateTest, IsToldOfARequestWhoseHeadIsBroken) {
  EXPECT_THAT(exchange("GET /hello HTTP/1.1\nHost: x\n\n\r\n\r\n"), StartsWith("HTTP/1.1 400"));
  const FinishedRequest& request = told_last();
  EXPECT_EQ(request.status, 400);
  EXPECT_EQ(request.path, "");
  EXPECT_EQ(gate.asked.size(), 0u);
}

TEST_F(GateTest, WhatItThrowsIsTheAnswer) {
  EXPECT_EQ(client().Get("/hello", {{"Authorization", "Bearer throw"}})->status, 503);
}

}  // namespace
}  // namespace mapweld::server
