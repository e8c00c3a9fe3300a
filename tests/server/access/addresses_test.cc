#include "server/access/addresses.h"

#include <gtest/gtest.h>

namespace mapweld::server {
namespace {

TEST(Addresses, LoopbackIsThisMachineOnly) {
  for (const char* own : {"127.0.0.1", "127.9.8.7", "::1", "localhost", "::ffff:127.0.0.1"}) {
    EXPECT_TRUE(is_loopback(own)) << own;
  }
  for (const char* other : {"0.0.0.0", "::", "10.0.0.1", "128.0.0.1", "::ffff:10.0.0.1", "", "no.such.host.invalid"}) {
    EXPECT_FALSE(is_loopback(other)) << other;
  }
  EXPECT_TRUE(is_loopback_address("::ffff:127.0.0.1"));
  EXPECT_FALSE(is_loopback_address("localhost"));
  EXPECT_FALSE(is_loopback_address("192.168.1.127"));
}

TEST(Addresses, ANetworkIsAnAddressOrHalfOfOne) {
  EXPECT_EQ(network_of("10.0.0.1"), "10.0.0.1");
  EXPECT_EQ(network_of("::ffff:10.0.0.1"), "10.0.0.1");
  EXPECT_EQ(network_of("2001:db8:1:2:3:4:5:6"), network_of("2001:db8:1:2::9"));
  EXPECT_NE(network_of("2001:db8:1:2::9"), network_of("2001:db8:1:3::9"));
}

TEST(Addresses, APageOfThisServerIsNoStranger) {
  EXPECT_TRUE(is_same_origin("http://127.0.0.1:8080", "127.0.0.1:8080"));
  EXPECT_TRUE(is_same_origin("http://Maps.example", "maps.example"));
  EXPECT_TRUE(is_same_origin("http://maps.example", "maps.example:80"));
  EXPECT_TRUE(is_same_origin("https://maps.example", "maps.example"));
  EXPECT_TRUE(is_same_origin("http://[::1]:8080", "[::1]:8080"));
  EXPECT_FALSE(is_same_origin("http://evil.example", "127.0.0.1:8080"));
  EXPECT_FALSE(is_same_origin("http://127.0.0.1:8081", "127.0.0.1:8080"));
  EXPECT_FALSE(is_same_origin("http://127.0.0.1:8080.evil.example", "127.0.0.1:8080"));
  EXPECT_FALSE(is_same_origin("null", "127.0.0.1:8080"));
  EXPECT_FALSE(is_same_origin("null", ""));
  EXPECT_FALSE(is_same_origin("file://", ""));
  EXPECT_FALSE(is_same_origin("http://a, http://b", "b"));
}

}  // namespace
}  // namespace mapweld::server
