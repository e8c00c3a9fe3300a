#include "server/services/times.h"

#include <gtest/gtest.h>

#include "server/services/hashing.h"

namespace mapweld::server {
namespace {

TEST(Times, AreWrittenAndReadBack) {
  const Timestamp time = parse_rfc3339("2026-11-23T10:00:00Z").value();
  EXPECT_EQ(time.time_since_epoch(), std::chrono::seconds(1795428000));  // date -u -d 2026-11-23T10:00:00Z +%s
  EXPECT_EQ(to_rfc3339(time), "2026-11-23T10:00:00Z");
  EXPECT_EQ(to_rfc3339(parse_rfc3339("2026-11-23t11:30:00.250+01:30").value()), "2026-11-23T10:00:00.25Z");
  EXPECT_EQ(to_rfc3339(parse_rfc3339("1969-12-31T23:59:59.5-00:00").value()), "1969-12-31T23:59:59.5Z");
  EXPECT_EQ(to_rfc3339(parse_rfc3339("2024-02-29T23:59:60Z").value()), "2024-03-01T00:00:00Z");
  EXPECT_EQ(to_rfc3339(parse_rfc3339("2026-01-01T00:00:00.123456789Z").value()), "2026-01-01T00:00:00.123456Z");
}

TEST(Times, WhatIsNoTimeIsNone) {
  for (const char* text : {"", "2026-11-23", "2026-11-23T10:00:00", "2026-11-23T10:00Z", "2026-13-01T00:00:00Z",
                           "2025-02-29T00:00:00Z", "2026-11-23T24:00:00Z", "2026-11-23T10:00:00.Z",
                           "2026-11-23T10:00:00+0100", "2026-11-23T10:00:00Zx", " 2026-11-23T10:00:00Z"}) {
    EXPECT_EQ(parse_rfc3339(text), std::nullopt) << text;
  }
}

TEST(Hashing, KnowsSha256) {
  const std::string text = "abc";
  EXPECT_EQ(to_hex(sha256({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()})),
            "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");  // FIPS 180-2, appendix B.1
}

}  // namespace
}  // namespace mapweld::server
