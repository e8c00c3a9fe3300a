// The whole program on real photographs: joined where places are shared, never where they are not.
#include <algorithm>
#include <fstream>
#include <set>
#include <sstream>

#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>

#include "client/client.h"
#include "client/image_folder.h"
#include "tests/integration/map_images.h"
#include "tests/support/overlays.h"
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
  const std::vector<Pair> strangers = {{"corridor-1", "office-reference"},
                                       {"corridor-1", "office-live"},
                                       {"corridor-2", "office-reference"},
                                       {"corridor-2", "office-live"},
                                       {"shop-A", "studio-A"},
                                       {"shop-A", "studio-B"},
                                       {"shop-B", "studio-A"},
                                       {"shop-B", "studio-B"},
                                       {"shop-A", "corridor-1"},
                                       {"studio-B", "office-live"}};
  for (const auto& [a, b] : strangers) {
    EXPECT_EQ(merge(client_, a, b, a + "-and-" + b).edges, 0) << a << " and " << b;
  }
}

// ---- What a camera carries with it ---------------------------------------------------------------------------------

// Every `step`-th photograph of a folder, named after a place; with something drawn over it.
Images photographs_of(const std::filesystem::path& folder, const std::string& place, std::size_t step = 1,
                      std::optional<rendered::Overlay> overlay = {}) {
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (entry.path().extension() == ".jpg" || entry.path().extension() == ".png") files.push_back(entry.path());
  }
  std::ranges::sort(files);
  Images images;
  for (std::size_t i = 0; i < files.size(); i += step) {
    std::string bytes = client::read_file(files[i]);
    if (overlay) {
      cv::Mat frame = cv::imdecode(std::vector<char>(bytes.begin(), bytes.end()), cv::IMREAD_COLOR);
      rendered::draw_overlay(frame, *overlay, static_cast<int>(place.size() * 100 + i));
      std::vector<std::uint8_t> encoded;
      cv::imencode(".jpg", frame, encoded, {cv::IMWRITE_JPEG_QUALITY, 88});
      bytes.assign(encoded.begin(), encoded.end());
    }
    images.push_back({place + "-" + files[i].filename().string(), bytes});
  }
  return images;
}

Images joined(Images images, const Images& more) {
  images.insert(images.end(), more.begin(), more.end());
  return images;
}

// Verified edges of a map within its places and between them, where the names of images begin with that of their place.
struct PlaceEdges {
  int within = 0;
  int between = 0;
};
PlaceEdges edges_of(client::Client& client, const std::string& map) {
  const auto vertices = *client.vertices(map);
  const auto place = [&](std::int64_t vertex) {
    const std::string& name = vertices.at(static_cast<std::size_t>(vertex)).name;
    return name.substr(0, name.find('-'));
  };
  PlaceEdges edges;
  for (const contract::Edge& edge : *client.edges(map)) {
    ++(place(edge.u) == place(edge.v) ? edges.within : edges.between);
  }
  return edges;
}

int localized(client::Client& client, const std::string& map, const Images& queries) {
  return static_cast<int>(std::ranges::count_if(queries, [&](const client::ImageFile& query) {
    return client.localize(map, query.bytes)->status != "not_found";
  }));
}

TEST_F(Photographs, TheTextOfACameraJoinsNoPlaces) {
  MAPWELD_REQUIRE_PHOTOGRAPHS(overlay, "../cases/static-overlay");
  const Images office = photographs_of(overlay / "office", "office");
  const Images corridor = photographs_of(overlay / "corridor", "corridor");
  upload(client_, "both", joined(office, corridor));
  const PlaceEdges edges = edges_of(client_, "both");
  EXPECT_EQ(edges.between, 0);
  EXPECT_GE(edges.within, 30);
  EXPECT_GT(client_.map("both")->static_share, 0.05);
  upload(client_, "office", office);
  EXPECT_EQ(localized(client_, "office", corridor), 0);
  EXPECT_EQ(localized(client_, "office", office), static_cast<int>(office.size()));
}

TEST_F(Photographs, NorDoesAnythingElseThatItCarries) {
  MAPWELD_REQUIRE_PHOTOGRAPHS(corridor, "corridor-two-laps");
  MAPWELD_REQUIRE_PHOTOGRAPHS(museum, "museum-region");
  MAPWELD_REQUIRE_PHOTOGRAPHS(office, "office-two-runs");
  for (const rendered::Overlay kind : rendered::kOverlays) {
    const std::string name(rendered::to_string(kind));
    upload(client_, name,
           joined(photographs_of(corridor / "lap-1", "corridor", 2, kind),
                  photographs_of(museum / "a", "museum", 5, kind)));
    // The wires of the wiper's heated pane are alike, and match one another elsewhere.
    EXPECT_LE(edges_of(client_, name).between, kind == rendered::Overlay::kWiper ? 8 : 0) << name;
    EXPECT_GT(client_.map(name)->static_share, 0.03) << name;
    EXPECT_EQ(localized(client_, name, photographs_of(office / "live", "office", 16, kind)), 0) << name;
  }
}

TEST_F(Photographs, OfOrdinaryPlacesNothingIsStatic) {
  MAPWELD_REQUIRE_PHOTOGRAPHS(corridor, "corridor-two-laps");
  MAPWELD_REQUIRE_PHOTOGRAPHS(office, "office-two-runs");
  upload_folder(client_, "corridor", corridor / "lap-1");
  upload_folder(client_, "office", office / "reference");
  for (const std::string map : {"corridor", "office"}) EXPECT_EQ(client_.map(map)->static_share, 0) << map;
}

}  // namespace
}  // namespace mapweld::testing
