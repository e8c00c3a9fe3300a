// The whole program on real photographs: joined where places are shared, never where they are not.
#include <gtest/gtest.h>

#include <fstream>
#include <set>
#include <sstream>

#include "client/client.h"
#include "tests/integration/map_images.h"
#include "tests/support/server_process.h"
#include "tests/support/temp_store.h"

namespace mapweld::testing {
namespace {

using Pair = std::pair<std::string, std::string>;

// Inter edges as pairs of image names, member by member.
std::set<Pair> joined_names(client::Client& client, const contract::Merge& done) {
  const auto graph = client.graph(done.map);
  std::set<Pair> names;
  for (const auto& edge : *client.merge_edges(done.id)) {
    names.emplace(graph.vertices.at(static_cast<std::size_t>(edge.u)).name,
                  graph.vertices.at(static_cast<std::size_t>(edge.v)).name);
  }
  return names;
}

class Photographs : public ::testing::Test {
 protected:
  Photographs() : server_(folder_.path()), client_(server_.url()) {}
  test::TempFolder folder_;
  ServerProcess server_;
  client::Client client_;
};

TEST_F(Photographs, CorridorLapsJoinAndBothMethodsAgree) {
  MAPWELD_REQUIRE_PHOTOGRAPHS(corridor, "corridor-two-laps");
  upload_folder(client_, "lap-1", corridor / "lap-1");
  upload_folder(client_, "lap-2", corridor / "lap-2");
  const auto quick = merge(client_, "lap-1", "lap-2", "quick", "quickconnect");
  const auto brute = merge(client_, "lap-1", "lap-2", "brute", "brute-force");
  const auto joined = joined_names(client_, quick);
  EXPECT_EQ(joined, joined_names(client_, brute));
  EXPECT_GE(joined.size(), 20u);
}

TEST_F(Photographs, OfficeRunsJoinAndBothMethodsAgree) {
  MAPWELD_REQUIRE_PHOTOGRAPHS(office, "office-two-runs");
  upload_folder(client_, "reference", office / "reference");
  upload_folder(client_, "live", office / "live");
  const auto quick = merge(client_, "reference", "live", "quick", "quickconnect");
  const auto brute = merge(client_, "reference", "live", "brute", "brute-force");
  EXPECT_GE(quick.edges, 100);
  EXPECT_EQ(joined_names(client_, quick), joined_names(client_, brute));
}

TEST_F(Photographs, DifferentPlacesGetNoInterEdge) {
  MAPWELD_REQUIRE_PHOTOGRAPHS(corridor, "corridor-two-laps");
  MAPWELD_REQUIRE_PHOTOGRAPHS(office, "office-two-runs");
  MAPWELD_REQUIRE_PHOTOGRAPHS(places, "places-two-visits");
  upload_folder(client_, "corridor-1", corridor / "lap-1");
  upload_folder(client_, "corridor-2", corridor / "lap-2");
  upload_folder(client_, "office-reference", office / "reference");
  upload_folder(client_, "office-live", office / "live");
  for (const std::string visit : {"A", "B"}) {
    upload_folder(client_, "shop-" + visit, places / "magasin" / visit);
    upload_folder(client_, "studio-" + visit, places / "studio" / visit);
  }
  const std::vector<Pair> strangers = {
      {"corridor-1", "office-reference"}, {"corridor-1", "office-live"}, {"corridor-2", "office-reference"},
      {"corridor-2", "office-live"},      {"shop-A", "studio-A"},        {"shop-A", "studio-B"},
      {"shop-B", "studio-A"},             {"shop-B", "studio-B"},        {"shop-A", "corridor-1"},
      {"studio-B", "office-live"}};
  for (const auto& [a, b] : strangers) {
    EXPECT_EQ(merge(client_, a, b, a + "-and-" + b).edges, 0) << a << " and " << b;
  }
}

}  // namespace
}  // namespace mapweld::testing
