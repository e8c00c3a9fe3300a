// Images that are deleted and restored, through the services: against maps that never had them.
#include "server/services/removal_service.h"

#include <chrono>
#include <functional>
#include <map>
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "client/contract/codec.h"
#include "schema/maps/map_store.h"
#include "schema/store_check.h"
#include "server/services/graph_export.h"
#include "server/services/pair_service.h"
#include "server/services/route_service.h"
#include "tests/server/support/services_under_test.h"
#include "tests/server/support/test_photos.h"

namespace mapweld::test {
namespace {

using contract::Json;

constexpr int kSteps = 7;

class Removal : public ::testing::Test {
 protected:
  void drive(const std::string& map, const std::set<int>& without = {}, std::uint32_t wall = 1) {
    services_.create_map(map);
    for (int step = 0; step < kSteps; ++step) {
      if (!without.contains(step)) services_.upload(map, "step-" + std::to_string(step), photo_jpeg(wall, step));
    }
  }

  contract::Localization localize(const std::string& map, const std::string& image) {
    server::LocalizeQuery query;
    query.image = {reinterpret_cast<const std::uint8_t*>(image.data()), image.size()};
    query.limit = 1000;
    contract::Localization found = services_.localization().localize(map, query);
    found.took_ms = 0;
    return found;
  }

  Json graph(const std::string& map) {
    std::string text;
    const auto next = server::export_graph(services_.store(), map, server::GraphFormat::kJson);
    while (next(text)) continue;
    return contract::parse_json(text);
  }

  // All that is said of a map but its own name, what it counts by, and when it was made; vertices by their names.
  std::string told(const std::string& map) {
    Json told = {{"edges", Json::array()}, {"vertices", Json::array()}, {"found", Json::array()}};
    std::map<std::int64_t, std::string> names;
    const Json all = graph(map);
    for (Json vertex : all["vertices"]) {
      names[vertex["vertex"]] = vertex["name"];
      for (const char* own : {"vertex", "member_vertex", "map"}) vertex.erase(own);
      told["vertices"].push_back(vertex);
    }
    for (Json edge : all["edges"]) {
      for (const char* end : {"u", "v"}) edge[end] = names.at(edge[end]);
      told["edges"].push_back(edge);
    }
    for (int step = 0; step < kSteps; ++step) {
      Json found = localize(map, photo_jpeg(1, step));
      for (Json& match : found["matches"]) {
        EXPECT_EQ(match["name"], names.at(match["vertex"]));
        for (const char* own : {"vertex", "member_vertex", "map"}) match.erase(own);
      }
      told["found"].push_back(found);
    }
    told["quality"] = services_.quality().quality(map);
    const contract::Map row = services_.maps().get(map);
    told["counts"] = {row.vertices, row.edges, row.edge_counts.verified, row.static_share};
    return told.dump(1);
  }

  std::string code(const std::function<void()>& call) { return code_of(call); }
  void expect_in_order() {
    for (const Finding& finding : check_store(services_.store().read()).findings) {
      ADD_FAILURE() << finding.where << ": " << finding.what;
    }
  }

  ServicesUnderTest services_;
};

TEST_F(Removal, AMapWithoutImagesIsOneThatNeverHadThem) {
  drive("lab");
  drive("never", {2, 5});
  localize("lab", photo_jpeg(1, 2));  // in memory
  EXPECT_EQ(services_.removals().remove("lab", 2), 1);
  EXPECT_EQ(services_.removals().remove_named("lab", "step-5"), 1);
  EXPECT_EQ(told("lab"), told("never"));
  services_.restart();
  EXPECT_EQ(told("lab"), told("never"));
  expect_in_order();

  const auto refused = [&](const std::function<void()>& call) { return code_of(call); };
  EXPECT_EQ(refused([&] { services_.maps().vertex("lab", 2); }), "no_such_vertex");
  EXPECT_EQ(refused([&] { services_.maps().image("lab", 2); }), "no_such_vertex");
  EXPECT_TRUE(services_.maps().vertices("lab", "step-2", {}).items.empty());
  EXPECT_EQ(refused([&] { server::find_route(services_.store(), "lab", 0, 2); }), "no_such_vertex");
  EXPECT_EQ(refused([&] { server::explain_pair(services_.store(), "lab", 1, 2, true); }), "no_such_vertex");
  EXPECT_EQ(refused([&] { services_.removals().remove("lab", 2); }), "no_such_vertex");
  EXPECT_EQ(refused([&] { services_.removals().remove_named("lab", "step-2"); }), "no_such_vertex");
  EXPECT_EQ(services_.removals().remove_range("lab", 2, 2), 0);
  EXPECT_EQ(services_.removals().remove_range("lab", 4, 1'000'000), 2);
  EXPECT_EQ(services_.maps().get("lab").vertices, 3);
  EXPECT_EQ(refused([&] { services_.removals().remove_range("lab", 3, 2); }), "invalid_parameter");
}

TEST_F(Removal, UploadsGoOnAmongWhatIsLeft) {
  drive("lab");
  drive("never", {2, 3});
  services_.removals().remove_range("lab", 2, 3);
  for (const char* map : {"lab", "never"}) {
    EXPECT_EQ(services_.upload(map, "later", png(photo(1, 2))).upload.outcome, "inserted");
  }
  EXPECT_EQ(told("lab"), told("never"));
  EXPECT_EQ(services_.maps().vertices("lab", "later", {}).items.at(0).vertex, kSteps) << "numbers do not come back";
  EXPECT_EQ(code([&] { services_.upload("lab", "step-2", photo_jpeg(1, 2)); }), "name_taken");
  EXPECT_EQ(services_.upload("lab", "step-3-again", photo_jpeg(1, 3)).upload.outcome, "inserted") << "its twin is gone";
  expect_in_order();
}

TEST_F(Removal, RestoringIsAsBefore) {
  drive("lab");
  const Json graph_before = graph("lab");
  const std::string before = told("lab");
  contract::Map map = services_.maps().get("lab");
  services_.removals().remove_range("lab", 1, 4);
  EXPECT_NE(told("lab"), before);
  services_.restart();
  for (const std::uint32_t vertex : {3, 1, 4, 2}) services_.removals().restore("lab", vertex);
  services_.removals().restore("lab", 2);
  EXPECT_EQ(told("lab"), before);
  EXPECT_EQ(graph("lab"), graph_before);
  const contract::Map now = services_.maps().get("lab");
  EXPECT_GT(now.revision, map.revision);
  map.revision = now.revision;
  EXPECT_EQ(now, map);
  EXPECT_EQ(code([&] { services_.removals().restore("lab", kSteps); }), "no_such_vertex");
}

TEST_F(Removal, PixelsMayGoAlone) {
  drive("lab");
  const std::string before = told("lab");
  const auto revision = services_.maps().get("lab").revision;
  services_.removals().remove_image("lab", 3);
  services_.removals().remove_image("lab", 3);
  EXPECT_EQ(code([&] { services_.maps().image("lab", 3); }), "no_such_image");
  EXPECT_EQ(told("lab"), before);
  EXPECT_EQ(services_.maps().get("lab").revision, revision + 1);
  EXPECT_EQ(code([&] { services_.removals().remove_image("lab", 99); }), "no_such_vertex");
}

class RemovalInMerges : public Removal {
 protected:
  RemovalInMerges() {
    drive("a");
    drive("b", {0, 1});
  }
  contract::Merge merge(const std::vector<std::string>& maps, const std::string& name) {
    contract::SubmitMerge submit;
    submit.maps = maps;
    submit.name = name;
    const contract::Merge merge = services_.merges().submit(submit);
    services_.jobs().wait(merge.id, std::chrono::seconds(30));
    return services_.merges().get(merge.id);
  }
};

TEST_F(RemovalInMerges, MergedMapsLoseThemToo) {
  merge({"a", "b"}, "ab");
  localize("ab", photo_jpeg(1, 3));
  const std::string before = told("ab");
  const auto told_of_merge = [&] {
    Json merge = services_.merges().get(1);
    merge.erase("checkpoint");  // it ages
    return merge;
  };
  const Json merge_before = told_of_merge();
  const auto revision = services_.maps().get("ab").revision;
  EXPECT_EQ(code([&] { services_.removals().remove("ab", 3); }), "map_is_merged");

  services_.removals().remove("a", 3);
  EXPECT_GT(services_.maps().get("ab").revision, revision);
  EXPECT_EQ(services_.maps().get("ab").vertices, 2 * kSteps - 3);
  EXPECT_EQ(code([&] { services_.maps().vertex("ab", 3); }), "no_such_vertex");
  EXPECT_EQ(services_.maps().vertex("ab", 4).name, "step-4") << "numbers stay";
  const Json left = graph("ab");
  for (const Json& edge : left["edges"]) EXPECT_TRUE(edge["u"] != 3 && edge["v"] != 3);
  for (int step = 0; step < kSteps; ++step) {
    for (const contract::Match& match : localize("ab", photo_jpeg(1, step)).matches) EXPECT_NE(match.vertex, 3);
  }
  const contract::Merge now = services_.merges().get(1);
  EXPECT_EQ(now.edges,
            static_cast<std::int64_t>(services_.maps().edges("ab", {.inter = true}, {1000, {}}).items.size()));
  EXPECT_EQ(now.joined, services_.quality().quality("ab").joined);
  EXPECT_LT(now.edges, merge_before["edges"].get<std::int64_t>());
  expect_in_order();

  services_.restart();
  services_.removals().restore("a", 3);
  EXPECT_EQ(told("ab"), before);
  EXPECT_EQ(told_of_merge(), merge_before);
}

TEST_F(RemovalInMerges, AMergeThatIsNotAtRestKeepsItsImages) {
  merge({"a", "b"}, "ab");
  {
    WriteTransaction db = services_.store().write();
    db.prepare("UPDATE merges SET state = 'running'").run();
    db.commit();
  }
  const std::string stored = dump_store(services_.store());
  EXPECT_EQ(code([&] { services_.removals().remove("a", 3); }), "map_in_use");
  EXPECT_EQ(code([&] { services_.removals().restore("a", 3); }), "map_in_use");
  EXPECT_EQ(dump_store(services_.store()), stored);
  {
    WriteTransaction db = services_.store().write();
    db.prepare("UPDATE merges SET state = 'completed'").run();
    db.commit();
  }
  EXPECT_EQ(services_.removals().remove("a", 3), 1);
}

}  // namespace
}  // namespace mapweld::test
