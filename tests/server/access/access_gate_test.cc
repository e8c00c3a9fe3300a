#include "server/access/access_gate.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "client/contract/json.h"
#include "tests/server/access/keys_under_test.h"

namespace mapweld::server {
namespace {

using mapweld::test::KeysUnderTest;
using ::testing::AllOf;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::Pair;

// Routes of each kind, and heads that ask for them.
struct AccessGateTest : ::testing::Test {
  AccessGateTest() : ring(keys.folder()) {}

  AccessGate gate(AccessOptions options = {}) { return AccessGate(ring, std::move(options), LogFormat::kText); }

  RequestHead head(const std::string& method, const Route& route, const std::string& key = "") const {
    RequestHead head;
    head.request_id = "r";
    head.method = method;
    head.path = "/v1/maps";
    head.route = &route;
    head.host = "127.0.0.1:8080";
    head.peer = "127.0.0.1";
    if (!key.empty()) head.authorization = "Bearer " + key;
    return head;
  }

  static std::string code(const Admission& admission) {
    return admission.reply ? contract::parse_json(admission.reply->body).value("code", "") : "admitted";
  }
  static std::string detail(const Admission& admission) {
    return contract::parse_json(admission.reply.value().body).value("detail", "");
  }

  KeysUnderTest keys;
  KeyRing ring;
  const Route open{.method = "GET", .pattern = "/healthz", .role = Role::kAnybody};
  const Route look{.method = "GET", .pattern = "/v1/maps/{map}", .role = Role::kRead};
  const Route change{.method = "POST", .pattern = "/v1/maps", .role = Role::kWrite};
};

TEST_F(AccessGateTest, WithoutKeysEverybodyMayDoEverything) {
  AccessGate gate = this->gate();
  EXPECT_EQ(code(gate.admit(head("POST", change))), "admitted");
  EXPECT_EQ(code(gate.admit(head("POST", change, "whatever"))), "admitted");
}

TEST_F(AccessGateTest, WithKeysOneIsAskedFor) {
  const std::string key = keys.make("robot", "write");
  AccessGate gate = this->gate();
  EXPECT_EQ(code(gate.admit(head("GET", open))), "admitted");
  const Admission without = gate.admit(head("POST", change));
  EXPECT_EQ(without.reply.value().status, 401);
  EXPECT_THAT(detail(without), HasSubstr("MAPWELD_KEY"));
  EXPECT_THAT(without.reply->headers, Contains(Pair("WWW-Authenticate", "Bearer realm=\"mapweld\"")));
  const Admission wrong = gate.admit(head("POST", change, "mw_wrong"));
  EXPECT_EQ(code(wrong), "unauthorized");
  EXPECT_THAT(wrong.reply->headers, Contains(Pair("WWW-Authenticate", HasSubstr("invalid_token"))));
  const Admission right = gate.admit(head("POST", change, key));
  EXPECT_EQ(code(right), "admitted");
  EXPECT_EQ(right.caller->name, "robot");
  RequestHead nothing = head("GET", look);
  nothing.route = nullptr;  // what there is not is told to those who have a key
  EXPECT_EQ(code(gate.admit(nothing)), "unauthorized");
  keys.revoke("robot");
  EXPECT_EQ(code(gate.admit(head("POST", change, key))), "unauthorized");
}

TEST_F(AccessGateTest, ARefusalByRoleSaysWhichIsNeeded) {
  const Admission refused = gate().admit(head("POST", change, keys.make("viewer", "read")));
  EXPECT_EQ(refused.reply.value().status, 403);
  EXPECT_EQ(detail(refused), "The key \"viewer\" is of role read; this takes write. Use another key.");
  EXPECT_EQ(refused.caller->name, "viewer");  // for the log
}

TEST_F(AccessGateTest, TheMapInThePathMustFit) {
  RequestHead request = head("GET", look, keys.make("lab", "operate", "lab-*"));
  request.parameters["map"] = "lab-a";
  AccessGate gate = this->gate();
  EXPECT_EQ(code(gate.admit(request)), "admitted");
  request.parameters["map"] = "hall";
  EXPECT_EQ(code(gate.admit(request)), "forbidden");
}

TEST_F(AccessGateTest, APageFromElsewhereMayChangeNothing) {
  AccessGate gate = this->gate();
  RequestHead request = head("POST", change);
  request.origin = "http://evil.example";
  EXPECT_EQ(code(gate.admit(request)), "forbidden");
  request.origin = "null";
  EXPECT_EQ(code(gate.admit(request)), "forbidden");
  request.origin = "http://127.0.0.1:8080";
  EXPECT_EQ(code(gate.admit(request)), "admitted");
  RequestHead looking = head("GET", look);
  looking.origin = "http://evil.example";
  const Admission looked = gate.admit(looking);
  EXPECT_EQ(code(looked), "admitted");
  EXPECT_TRUE(looked.headers.empty());  // so that the browser keeps the answer from the page
}

TEST_F(AccessGateTest, AnOriginCanBeAllowed) {
  keys.make("robot", "write");
  AccessGate gate = this->gate({.cors_origins = {"https://ours.example"}});
  RequestHead preflight = head("OPTIONS", change);
  preflight.route = nullptr;
  preflight.allow = "POST, GET";
  preflight.origin = "https://ours.example";
  const Admission answered = gate.admit(preflight);  // browsers send no key with it
  EXPECT_EQ(answered.reply.value().status, 204);
  EXPECT_THAT(answered.reply->headers, Contains(Pair("Access-Control-Allow-Methods", "POST, GET")));
  EXPECT_THAT(
      answered.reply->headers,
      Contains(Pair("Access-Control-Allow-Headers",
                    AllOf(HasSubstr("Idempotency-Key"), HasSubstr("If-None-Match"), HasSubstr("Last-Event-ID")))));
  EXPECT_THAT(answered.headers, Contains(Pair("Access-Control-Allow-Origin", "https://ours.example")));
  RequestHead request = head("POST", change);
  request.origin = "https://ours.example";
  const Admission refused = gate.admit(request);
  EXPECT_EQ(code(refused), "unauthorized");
  EXPECT_THAT(refused.headers, Contains(Pair("Access-Control-Allow-Origin", "https://ours.example")));
  preflight.origin = "https://evil.example";
  EXPECT_EQ(code(gate.admit(preflight)), "unauthorized");
}

TEST_F(AccessGateTest, AKeyHasItsRate) {
  const std::string busy = keys.make("busy", "write");
  const std::string other = keys.make("other", "write");
  AccessGate gate = this->gate({.per_caller = {.per_s = 0.5, .burst = 3}});
  for (int i = 0; i < 3; ++i) EXPECT_EQ(code(gate.admit(head("POST", change, busy))), "admitted");
  const Admission limited = gate.admit(head("POST", change, busy));
  EXPECT_EQ(limited.reply.value().status, 429);
  EXPECT_EQ(code(limited), "rate_limited");
  EXPECT_EQ(std::count(limited.reply->headers.begin(), limited.reply->headers.end(),
                       std::pair<std::string, std::string>("Retry-After", "2")),
            1);
  EXPECT_EQ(code(gate.admit(head("POST", change, other))), "admitted");
  EXPECT_EQ(code(gate.admit(head("GET", open))), "admitted");
}

TEST_F(AccessGateTest, WithoutKeysAnAddressHasItsRateAndLoopbackNone) {
  AccessGate gate = this->gate({.per_caller = {.per_s = 0.5, .burst = 1}});
  for (int i = 0; i < 5; ++i) EXPECT_EQ(code(gate.admit(head("POST", change))), "admitted");
  RequestHead far = head("POST", change);
  far.peer = "10.0.0.7";
  EXPECT_EQ(code(gate.admit(far)), "admitted");
  EXPECT_EQ(code(gate.admit(far)), "rate_limited");
  far.peer = "10.0.0.8";
  EXPECT_EQ(code(gate.admit(far)), "admitted");
}

TEST_F(AccessGateTest, WhoTriesKeysIsSlowedDownAndNobodyElse) {
  const std::string key = keys.make("robot", "write");
  AccessGate gate = this->gate({.refused_per_address = {.per_s = 0.5, .burst = 2}});
  for (int i = 0; i < 2; ++i) EXPECT_EQ(code(gate.admit(head("POST", change, "mw_guess"))), "unauthorized");
  EXPECT_EQ(code(gate.admit(head("POST", change, "mw_guess"))), "rate_limited");
  EXPECT_EQ(code(gate.admit(head("POST", change, key))), "admitted");
}

}  // namespace
}  // namespace mapweld::server
