#include "server/access/access_log.h"

#include <memory>
#include <sstream>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <spdlog/sinks/ostream_sink.h>
#include <spdlog/spdlog.h>

#include "client/contract/json.h"

namespace mapweld::server {
namespace {

using contract::Json;
using ::testing::HasSubstr;

FinishedRequest a_change() {
  FinishedRequest request;
  request.request_id = "5fafc65f-000003";
  request.method = "POST";
  request.path = "/v1/merges";
  request.route = "/v1/merges";
  request.role = Role::kOperate;
  request.peer = "10.0.0.7";
  request.subject = "lab of lab-a lab-b";
  request.caller = std::make_shared<Caller>(Caller{.name = "robot-1"});
  request.status = 202;
  request.bytes_in = 45;
  request.bytes_out = 900;
  request.elapsed_s = 0.01234;
  return request;
}

struct AccessLogTest : ::testing::Test {
  ~AccessLogTest() override {
    spdlog::drop("access");
    spdlog::drop("audit");
  }
  // What is logged of a request.
  std::string told(const FinishedRequest& request, LogFormat format, spdlog::level::level_enum level) {
    std::ostringstream out;
    const auto sink = std::make_shared<spdlog::sinks::ostream_sink_st>(out);
    for (const char* name : {"access", "audit"}) {
      spdlog::drop(name);
      const auto logger = std::make_shared<spdlog::logger>(name, sink);
      logger->set_level(level);
      spdlog::register_logger(logger);
    }
    if (format == LogFormat::kJson) {
      sink->set_formatter(make_json_formatter());
    } else {
      sink->set_pattern("%n %l %v");
    }
    AccessLog(format).tell(request);
    return out.str();
  }
};

TEST_F(AccessLogTest, ARequestIsALineAndAChangeAnother) {
  EXPECT_EQ(
      told(a_change(), LogFormat::kText, spdlog::level::info),
      "access info event=request request_id=5fafc65f-000003 key=robot-1 peer=10.0.0.7 method=POST route=/v1/merges "
      "path=/v1/merges status=202 elapsed_ms=12.34 bytes_in=45 bytes_out=900\n"
      "audit info event=change request_id=5fafc65f-000003 key=robot-1 peer=10.0.0.7 method=POST path=/v1/merges "
      "subject=\"lab of lab-a lab-b\" status=202\n");
}

TEST_F(AccessLogTest, JsonLinesHaveTheSameFields) {
  std::istringstream lines(told(a_change(), LogFormat::kJson, spdlog::level::info));
  std::string line;
  ASSERT_TRUE(std::getline(lines, line));
  const Json request = Json::parse(line);
  EXPECT_EQ(request["level"], "info");
  EXPECT_THAT(request["time"].get<std::string>(), HasSubstr("T"));
  EXPECT_EQ(request["event"], "request");
  EXPECT_EQ(request["key"], "robot-1");
  EXPECT_EQ(request["status"], 202);
  EXPECT_EQ(request["elapsed_ms"], 12.34);
  EXPECT_EQ(request["bytes_out"], 900);
  ASSERT_TRUE(std::getline(lines, line));
  EXPECT_EQ(Json::parse(line)["subject"], "lab of lab-a lab-b");
}

TEST_F(AccessLogTest, WhatIsNoTextDoesNotBreakTheLine) {
  FinishedRequest request = a_change();
  request.path = "/v1/maps/\"\xff{}";
  std::istringstream lines(told(request, LogFormat::kJson, spdlog::level::info));
  std::string line;
  ASSERT_TRUE(std::getline(lines, line));
  EXPECT_THAT(Json::parse(line)["path"].get<std::string>(), HasSubstr("\"\xEF\xBF\xBD{}"));
}

TEST_F(AccessLogTest, OtherLinesAreMessages) {
  std::ostringstream out;
  const auto sink = std::make_shared<spdlog::sinks::ostream_sink_st>(out);
  spdlog::logger logger("mapweld", sink);
  sink->set_formatter(make_json_formatter());
  logger.warn("{\"a\" broken\nline}");
  EXPECT_EQ(Json::parse(out.str())["message"], "{\"a\" broken\nline}");
}

TEST_F(AccessLogTest, LookingAndFailingChangesNothing) {
  FinishedRequest looked = a_change();
  looked.role = Role::kRead;
  EXPECT_EQ(told(looked, LogFormat::kText, spdlog::level::info).find("event=change"), std::string::npos);
  FinishedRequest refused = a_change();
  refused.status = 403;
  EXPECT_EQ(told(refused, LogFormat::kText, spdlog::level::info).find("event=change"), std::string::npos);
}

TEST_F(AccessLogTest, MachinesThatAskAgainAndAgainAreToldAtDebug) {
  FinishedRequest health;
  health.method = "GET";
  health.path = health.route = "/healthz";
  health.status = 200;
  EXPECT_EQ(told(health, LogFormat::kText, spdlog::level::info), "");
  EXPECT_THAT(told(health, LogFormat::kText, spdlog::level::debug), HasSubstr("access debug event=request"));
}

}  // namespace
}  // namespace mapweld::server
