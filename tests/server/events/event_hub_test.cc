#include "server/events/event_hub.h"

#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "client/contract/problem.h"

namespace mapweld::server {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

// A hub whose clock the test turns.
class EventHubTest : public ::testing::Test {
 protected:
  EventHubTest()
      : hub_({.keep = 5, .keep_for = std::chrono::seconds(100), .max_streams = 3}, [this] { return now_; }) {}

  void tell(const std::string& word, std::optional<std::int64_t> merge = {}, std::optional<std::uint64_t> step = {}) {
    hub_.tell({.type = "edge", .data = "{\"word\":\"" + word + "\"}", .maps = {word}, .merge = merge, .step = step});
  }
  static std::string taken(const std::shared_ptr<EventStream>& stream) { return stream->take().text; }
  // Of the last event in `text` that bears one.
  static std::string last_id(const std::string& text) {
    const std::size_t at = text.rfind("id: ");
    return at == std::string::npos ? "" : text.substr(at + 4, text.find('\n', at) - at - 4);
  }

  std::chrono::system_clock::time_point now_{std::chrono::hours(24 * 365 * 50)};
  EventHub hub_;
};

TEST_F(EventHubTest, TellsWhatHappensFromNowOn) {
  tell("before");
  const auto stream = hub_.listen({}, {}, "");
  EXPECT_EQ(taken(stream), ": mapweld\n\n");
  tell("one");
  tell("two");
  const std::string text = taken(stream);
  EXPECT_THAT(text, HasSubstr("\nevent: edge\ndata: {\"word\":\"one\"}\n\nid: "));
  EXPECT_THAT(text, HasSubstr("two"));
  EXPECT_THAT(text, Not(HasSubstr("before")));
  EXPECT_EQ(taken(stream), "");
}

TEST_F(EventHubTest, WhoComesBackMissesNothing) {
  auto stream = hub_.listen({}, {}, "");
  tell("one");
  const std::string id = last_id(taken(stream));
  stream.reset();
  tell("two");
  tell("three");
  const std::string text = taken(hub_.listen({}, {}, id));
  EXPECT_THAT(text, Not(HasSubstr("one")));
  EXPECT_THAT(text, HasSubstr("two"));
  EXPECT_THAT(text, HasSubstr("three"));
  EXPECT_THAT(text, Not(HasSubstr("reset")));
}

TEST_F(EventHubTest, WhatIsNotKeptAnyMoreIsAReset) {
  const auto stream = hub_.listen({}, {}, "");
  tell("one");
  const std::string id = last_id(taken(stream));
  for (int i = 0; i < 4; ++i) tell("more");
  EXPECT_THAT(taken(hub_.listen({}, {}, id)), Not(HasSubstr("reset")));
  tell("too much");
  EXPECT_THAT(taken(hub_.listen({}, {}, id)), HasSubstr("event: reset\n"));
  const std::string newer = last_id(taken(stream));
  now_ += std::chrono::seconds(101);
  EXPECT_THAT(taken(hub_.listen({}, {}, newer)), HasSubstr("event: reset\n"));
}

TEST_F(EventHubTest, IdsOfFormerLivesAndNonsenseAreAReset) {
  for (const char* id : {"1", "99999999999999999999", "x", "-1"}) {
    EXPECT_THAT(taken(hub_.listen({}, {}, id)), HasSubstr("event: reset\n")) << id;
  }
  now_ += std::chrono::seconds(1);
  EventHub next({}, [this] { return now_; });
  const auto stream = hub_.listen({}, {}, "");
  const auto stream_then = next.listen({}, {}, "");
  tell("one");
  next.tell({.type = "edge", .data = "{}"});
  EXPECT_LT(std::stoull(last_id(taken(stream))), std::stoull(last_id(taken(stream_then))));
}

TEST_F(EventHubTest, TheIdOfAMergesEventsIsItsStep) {
  const auto stream = hub_.listen({}, 7, "");
  taken(stream);
  tell("first", 7, 20);
  tell("other", 8, 21);
  tell("same", 7, 20);
  tell("next", 7, 22);
  EXPECT_EQ(taken(stream),
            "id: 20\nevent: edge\ndata: {\"word\":\"first\"}\n\nevent: edge\ndata: {\"word\":\"same\"}\n\n"
            "id: 22\nevent: edge\ndata: {\"word\":\"next\"}\n\n");
  // Who saw the first of step 20 may not have seen the second.
  const std::string text = taken(hub_.listen({}, 7, "20"));
  EXPECT_THAT(text, Not(HasSubstr("first")));
  EXPECT_THAT(text, HasSubstr("same"));
  EXPECT_THAT(text, HasSubstr("next"));
  EXPECT_THAT(taken(hub_.listen({}, 7, "21")), HasSubstr("reset"));
}

TEST_F(EventHubTest, AMergeThatBeganAfreshIsFoundAtItsLastTime) {
  tell("old", 7, 20);
  tell("older", 7, 30);
  tell("new", 7, 20);
  tell("newer", 7, 25);
  const std::string text = taken(hub_.listen({}, 7, "20"));
  EXPECT_THAT(text, Not(HasSubstr("older")));
  EXPECT_THAT(text, HasSubstr("newer"));
}

TEST_F(EventHubTest, GreetsThoseWhoKnowNothing) {
  const Event state{.type = "state", .data = "{\"state\":\"running\"}"};
  EXPECT_THAT(taken(hub_.listen({}, 7, "", {state})), HasSubstr("event: state\ndata: {\"state\":\"running\"}\n\n"));
  EXPECT_THAT(taken(hub_.listen({}, 7, "5", {state})), HasSubstr("event: reset\ndata: {}\n\nevent: state\n"));
  tell("one", 7, 5);
  EXPECT_THAT(taken(hub_.listen({}, 7, "5", {state})), Not(HasSubstr("state")));
}

TEST_F(EventHubTest, AFilterIsAskedForEveryEvent) {
  const auto stream = hub_.listen([](const Event& event) { return event.maps.at(0) != "secret"; }, {}, "");
  tell("open");
  tell("secret");
  const std::string text = taken(stream);
  EXPECT_THAT(text, HasSubstr("open"));
  EXPECT_THAT(text, Not(HasSubstr("secret")));
  EXPECT_THAT(taken(hub_.listen([](const Event&) { return false; }, {}, last_id(text))), Not(HasSubstr("secret")));
}

TEST_F(EventHubTest, StreamsAreCountedWhileTheyAreHeld) {
  auto one = hub_.listen({}, {}, "");
  const auto two = hub_.listen({}, {}, "");
  const auto three = hub_.listen({}, {}, "");
  EXPECT_THROW(hub_.listen({}, {}, ""), contract::ContractError);
  one.reset();
  EXPECT_NO_THROW(hub_.listen({}, {}, ""));
}

TEST_F(EventHubTest, ClosingEndsAllStreams) {
  const auto stream = hub_.listen({}, {}, "");
  tell("last");
  hub_.close();
  const EventStream::Taken taken = stream->take();
  EXPECT_THAT(taken.text, HasSubstr("last"));
  EXPECT_TRUE(taken.ended);
  EXPECT_TRUE(hub_.listen({}, {}, "")->take().ended);
}

TEST(EventStream, WhoReadsTooSlowlyIsGivenUp) {
  EventStream stream(10);
  int woken = 0;
  stream.set_wake([&] { ++woken; });
  EXPECT_TRUE(stream.push("12345"));
  EXPECT_TRUE(stream.push("67890"));
  EXPECT_EQ(woken, 1);
  EXPECT_EQ(stream.take().text, "1234567890");
  EXPECT_TRUE(stream.push("12345"));
  EXPECT_EQ(woken, 2);
  EXPECT_FALSE(stream.push("678901"));
  EXPECT_TRUE(stream.take().ended);
  EXPECT_FALSE(stream.push("x"));
}

}  // namespace
}  // namespace mapweld::server
