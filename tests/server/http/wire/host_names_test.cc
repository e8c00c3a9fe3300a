#include "server/http/wire/host_names.h"

#include <gtest/gtest.h>

namespace mapweld::server {
namespace {

TEST(HostNames, AddressesAndWhatIsMeantHereAreKnown) {
  const HostNames names("maps.example", {"Robots.Example"});
  for (const char* host : {"127.0.0.1", "127.0.0.1:8080", "192.168.1.7:80", "[::1]:8080", "[fe80::1]", "localhost",
                           "LOCALHOST:8080", "a.localhost", "maps.example", "Maps.Example:443", "robots.example"}) {
    EXPECT_TRUE(names.know(host)) << host;
  }
}

TEST(HostNames, OthersAreNot) {
  const HostNames names("127.0.0.1", {"robots.example"});
  for (const char* host :
       {"evil.example", "evil.example:8080", "127.0.0.1.evil.example", "localhost.evil.example", "notlocalhost",
        "xrobots.example", "x.robots.example", "", ":80", "[::1", "[evil.example]"}) {
    EXPECT_FALSE(names.know(host)) << host;
  }
}

TEST(HostNames, AStarAllowsEveryName) {
  EXPECT_TRUE(HostNames("127.0.0.1", {"*"}).know("evil.example"));
  EXPECT_FALSE(HostNames("127.0.0.1", {"*.example"}).know("evil.example"));
}

}  // namespace
}  // namespace mapweld::server
