#include "server/services/map_service.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "client/contract/names.h"
#include "client/contract/problem.h"
#include "server/services/graph_export.h"
#include "server/services/route_service.h"
#include "server/services/times.h"
#include "tests/server/support/services_under_test.h"
#include "tests/server/support/test_photos.h"

namespace mapweld::test {
namespace {

using server::GraphFormat;
using server::PageRequest;
using ::testing::HasSubstr;

contract::CreateMap named(const std::string& name) {
  contract::CreateMap request;
  request.name = name;
  return request;
}

TEST(MapService, AMapTellsWhatItIs) {
  ServicesUnderTest services;
  contract::CreateMap request = named("lab-a");
  request.uuid = "A0EEBC99-9C0B-4EF8-BB6D-6BB9BD380A11";
  request.labels = {{"robot", "p3at-1"}, {"raum", "küche \"7\""}};
  request.parameters.emplace();
  request.parameters->max_features = 300;
  request.parameters->votes = "product";
  const contract::Map created = services.maps().create(request);
  EXPECT_EQ(created, services.maps().get("lab-a"));
  EXPECT_EQ(created.kind, "map");
  EXPECT_EQ(created.vocabulary, "words");
  EXPECT_EQ(created.uuid, "a0eebc99-9c0b-4ef8-bb6d-6bb9bd380a11");
  EXPECT_EQ(created.labels, *request.labels);
  EXPECT_EQ(created.parameters.max_features, 300);
  EXPECT_EQ(created.parameters.votes, "product");
  EXPECT_TRUE(created.parameters.min_votes && created.parameters.min_inliers && created.parameters.max_inliers &&
              created.parameters.verify_top && created.parameters.store_images);
  EXPECT_TRUE(server::parse_rfc3339(created.created_at).has_value());
  EXPECT_TRUE(contract::is_uuid(services.maps().create(named("lab-b")).uuid));
}

TEST(MapService, FewestVotesAreThoseOfTheRule) {
  ServicesUnderTest services;
  contract::CreateMap request = named("lab-a");
  const contract::Map usual = services.maps().create(request);
  EXPECT_EQ(usual.parameters.votes, "signatures");
  EXPECT_EQ(usual.parameters.min_votes, 3);
  for (const char* rule : {"min", "product"}) {
    request = named(rule);
    request.parameters.emplace().votes = rule;
    EXPECT_EQ(services.maps().create(request).parameters.min_votes, 10) << rule;
  }
  request = named("strict");
  request.parameters.emplace().min_votes = 7;
  EXPECT_EQ(services.maps().create(request).parameters.min_votes, 7);
}

TEST(MapService, BrokenRequestsChangeNothing) {
  ServicesUnderTest services;
  contract::CreateMap first = named("lab");
  first.uuid = "a0eebc99-9c0b-4ef8-bb6d-6bb9bd380a11";
  services.maps().create(first);
  const std::string stored = dump_store(services.store());
  const auto code = [&](const contract::CreateMap& request) {
    return code_of([&] { services.maps().create(request); });
  };
  EXPECT_EQ(code(named("lab")), "name_taken");
  contract::CreateMap request = named("other");
  request.uuid = "A0EEBC99-9C0B-4EF8-BB6D-6BB9BD380A11";
  EXPECT_EQ(code(request), "name_taken");
  EXPECT_EQ(code(named("")), "invalid_name");
  EXPECT_EQ(code(named("../etc")), "invalid_name");
  request = named("other");
  request.vocabulary = "none";
  EXPECT_EQ(code(request), "no_such_vocabulary");
  request = named("other");
  request.parameters.emplace();
  request.parameters->min_inliers = 60'000;  // more than the default max_inliers
  EXPECT_EQ(code(request), "invalid_parameter");
  EXPECT_EQ(code_of([&] { services.maps().get("other"); }), "no_such_map");
  EXPECT_EQ(code_of([&] { services.maps().remove("other"); }), "no_such_map");
  EXPECT_EQ(code_of([&] { services.maps().list({10, "x"}); }), "invalid_parameter");
  EXPECT_EQ(code_of([&] { services.maps().list({10, "-1"}); }), "invalid_parameter");
  EXPECT_EQ(dump_store(services.store()), stored);
}

contract::ChangeMap changing(const std::string& body) {
  return contract::read_request<contract::ChangeMap>(contract::parse_json(body));
}

TEST(MapService, WhatAChangeLeavesOutStays) {
  ServicesUnderTest services;
  contract::CreateMap request = named("lab");
  request.labels = {{"robot", "p3at-1"}, {"floor", "2"}};
  request.parameters.emplace().max_inliers = 300;
  contract::Map expected = services.maps().create(request);
  services.create_map("other");

  contract::Map changed = services.maps().change("lab", changing(R"({"parameters":{"verify_top":7}})"));
  expected.parameters.verify_top = 7;
  ++expected.revision;
  EXPECT_EQ(changed, expected);
  changed = services.maps().change("lab", changing(R"({"name":"hall","labels":{"robot":"p3at-2"}})"));
  expected.name = "hall";
  expected.labels = {{"robot", "p3at-2"}};
  ++expected.revision;
  EXPECT_EQ(changed, expected);
  EXPECT_EQ(code_of([&] { services.maps().get("lab"); }), "no_such_map");
  services.restart();
  EXPECT_EQ(services.maps().get("hall"), expected);
  EXPECT_EQ(services.maps().change("hall", changing(R"({"name":"hall","parameters":{"max_features":500}})")), expected)
      << "nothing is changed";
  services.create_map("lab");  // the name is free
}

TEST(MapService, AChangeThatCannotBeChangesNothing) {
  ServicesUnderTest services;
  services.create_map("lab");
  services.create_map("other");
  const std::string stored = dump_store(services.store());
  const auto code = [&](const std::string& body) {
    return code_of([&] { services.maps().change("lab", changing(body)); });
  };
  EXPECT_EQ(code(R"({"name":"other","labels":{"a":"b"}})"), "name_taken");
  EXPECT_EQ(code(R"({"name":"../etc"})"), "invalid_name");
  EXPECT_EQ(code(R"({"uuid":"a0eebc99-9c0b-4ef8-bb6d-6bb9bd380a11"})"), "unknown_field");
  EXPECT_EQ(code(R"({"parameters":{"verify_bottom":1}})"), "unknown_field");
  EXPECT_EQ(code(R"({"parameters":{"verify_top":0}})"), "invalid_parameter");
  EXPECT_EQ(code(R"({"parameters":{"max_inliers":3}})"), "invalid_parameter") << "less than min_inliers";
  for (const char* parameter :
       {R"("max_features":400)", R"("votes":"min")", R"("min_votes":4)", R"("min_inliers":11)"}) {
    EXPECT_EQ(code(std::string(R"({"labels":{"a":"b"},"parameters":{)") + parameter + "}}"), "immutable_parameter");
  }
  EXPECT_EQ(code_of([&] { services.maps().change("none", changing("{}")); }), "no_such_map");
  EXPECT_EQ(dump_store(services.store()), stored);
}

TEST(MapService, ListsComeInPages) {
  ServicesUnderTest services;
  for (int i = 0; i < 5; ++i) services.create_map("map-" + std::to_string(i));
  std::vector<std::string> names;
  PageRequest page{2, std::nullopt};
  int pages = 0;
  do {
    const auto found = services.maps().list(page);
    EXPECT_LE(found.items.size(), 2u);
    for (const contract::Map& map : found.items) names.push_back(map.name);
    page.cursor = found.next_cursor;
    ++pages;
  } while (page.cursor);
  EXPECT_EQ(pages, 3);
  EXPECT_THAT(names, ::testing::ElementsAre("map-0", "map-1", "map-2", "map-3", "map-4"));
}

class DrivenMap : public ::testing::Test {
 protected:
  DrivenMap() {
    services_.create_map("lab");
    for (int step = 0; step < 5; ++step) services_.upload("lab", "step-" + std::to_string(step), photo_jpeg(1, step));
    services_.upload("lab", "blank", jpeg(blank()));
    services_.upload("lab", "again", png(photo(1, 2)));
  }

  std::string exported(GraphFormat format) {
    std::string text;
    const auto next = server::export_graph(services_.store(), "lab", format);
    while (next(text)) continue;
    return text;
  }

  ServicesUnderTest services_;
};

TEST_F(DrivenMap, VerticesAreListedAndFoundByName) {
  const auto first = services_.maps().vertices("lab", std::nullopt, {4, std::nullopt});
  ASSERT_EQ(first.items.size(), 4u);
  EXPECT_EQ(first.items[3].name, "step-3");
  EXPECT_EQ(first.items[3], services_.maps().vertex("lab", 3));
  EXPECT_GT(first.items[3].degree, 0);
  EXPECT_EQ(first.items[3].map, "lab");
  EXPECT_EQ(first.items[3].member_vertex, 3);
  EXPECT_EQ(first.items[3].width_px, 320);
  const auto rest = services_.maps().vertices("lab", std::nullopt, {4, first.next_cursor});
  ASSERT_EQ(rest.items.size(), 2u);
  EXPECT_EQ(rest.items[1].name, "blank");
  EXPECT_EQ(rest.items[1].degree, 0);
  EXPECT_EQ(rest.next_cursor, std::nullopt);
  const auto named = services_.maps().vertices("lab", "step-2", {});
  ASSERT_EQ(named.items.size(), 1u);
  EXPECT_EQ(named.items[0].vertex, 2);
  EXPECT_TRUE(services_.maps().vertices("lab", "again", {}).items.empty());  // ignored, no vertex
  EXPECT_EQ(code_of([&] { services_.maps().vertex("lab", 6); }), "no_such_vertex");
  EXPECT_EQ(code_of([&] { services_.maps().image("lab", 6); }), "no_such_vertex");
}

TEST_F(DrivenMap, ALongListSaysTheSameOfAVertexAsAShortOne) {
  for (int i = 0; i < 40; ++i) services_.upload("lab", "dot-" + std::to_string(i), png(blank(1 + i, 1)));
  const auto all = services_.maps().vertices("lab", std::nullopt, {1000, std::nullopt}).items;
  ASSERT_EQ(all.size(), 46u);
  EXPECT_EQ(all, services_.maps().vertices("lab", std::nullopt, {46, std::nullopt}).items);
  for (std::uint32_t i = 0; i < 7; ++i) EXPECT_EQ(all[i], services_.maps().vertex("lab", i));
}

TEST_F(DrivenMap, EdgesAreFilteredAndPaged) {
  const auto all = services_.maps().edges("lab", {}, {1000, std::nullopt});
  ASSERT_GE(all.items.size(), 4u);
  std::vector<contract::Edge> paged;
  PageRequest page{2, std::nullopt};
  do {
    const auto found = services_.maps().edges("lab", {}, page);
    paged.insert(paged.end(), found.items.begin(), found.items.end());
    page.cursor = found.next_cursor;
  } while (page.cursor);
  EXPECT_EQ(paged, all.items);
  std::size_t strong = 0;
  const std::uint32_t median = static_cast<std::uint32_t>(all.items[all.items.size() / 2].inliers);
  for (const contract::Edge& edge : all.items) {
    EXPECT_LT(edge.u, edge.v);
    EXPECT_EQ(edge.kind, "inner");
    EXPECT_EQ(edge.merge, std::nullopt);
    EXPECT_LT(edge.log10_false_alarms, -6);
    strong += edge.inliers >= static_cast<int>(median) ? 1 : 0;
  }
  EXPECT_EQ(services_.maps().edges("lab", {median, std::nullopt}, {1000, std::nullopt}).items.size(), strong);
  EXPECT_TRUE(services_.maps().edges("lab", {0, true}, {}).items.empty());
  EXPECT_EQ(code_of([&] { services_.maps().edges("lab", {}, {10, "7"}); }), "invalid_parameter");
}

TEST_F(DrivenMap, TheGraphIsExportedInEveryFormat) {
  const contract::Json json = contract::parse_json(exported(GraphFormat::kJson));
  const auto edges = services_.maps().edges("lab", {}, {1000, std::nullopt});
  const auto graph = json.get<contract::Graph>();
  EXPECT_EQ(graph.edges, edges.items);
  EXPECT_EQ(graph.vertices, services_.maps().vertices("lab", std::nullopt, {1000, std::nullopt}).items);

  const std::string csv = exported(GraphFormat::kCsv);
  EXPECT_EQ(static_cast<std::size_t>(std::count(csv.begin(), csv.end(), '\n')), edges.items.size() + 1);
  EXPECT_THAT(csv, HasSubstr("0,1,inner,"));

  const std::string dot = exported(GraphFormat::kDot);
  EXPECT_THAT(dot, HasSubstr("graph \"lab\" {"));
  EXPECT_THAT(dot, HasSubstr("  0 -- 1 ["));
  EXPECT_THAT(dot, HasSubstr("5 [label=\"blank\""));

  const std::string graphml = exported(GraphFormat::kGraphml);
  EXPECT_THAT(graphml, HasSubstr("<node id=\"v5\"><data key=\"name\">blank</data>"));
  EXPECT_THAT(graphml, HasSubstr("<edge source=\"v0\" target=\"v1\">"));
  EXPECT_THAT(graphml, ::testing::EndsWith("</graphml>\n"));
}

TEST_F(DrivenMap, AnExportIsOfOneMomentHoweverSlowlyItIsRead) {
  const std::string whole = exported(GraphFormat::kJson);
  const auto next = server::export_graph(services_.store(), "lab", GraphFormat::kJson);
  std::string text;
  EXPECT_TRUE(next(text));
  EXPECT_LT(text.size(), whole.size());
  services_.upload("lab", "later", photo_jpeg(9, 0));
  while (next(text)) continue;
  EXPECT_EQ(text, whole);
  EXPECT_NE(exported(GraphFormat::kJson), whole);
}

TEST_F(DrivenMap, NamesAreEscapedInEveryFormat) {
  const std::string name = R"(a"<b>&\,c)";
  services_.upload("lab", name, photo_jpeg(9, 0));
  EXPECT_THAT(exported(GraphFormat::kGraphml), HasSubstr("a&quot;&lt;b&gt;&amp;\\,c"));
  EXPECT_THAT(exported(GraphFormat::kDot), HasSubstr(R"(label="a\"<b>&\\,c")"));
  EXPECT_EQ(contract::parse_json(exported(GraphFormat::kJson))["vertices"][6]["name"], name);
}

TEST_F(DrivenMap, QualityKnowsThatABlankWallIsNotConnected) {
  const contract::Quality quality = services_.quality().quality("lab");
  EXPECT_EQ(quality.vertices, 6);
  EXPECT_EQ(quality.components, 2);
  EXPECT_EQ(quality.algebraic_connectivity, 0);
  EXPECT_EQ(quality.edge_connectivity, 0);
  EXPECT_EQ(quality.min_degree, 0);
  EXPECT_EQ(quality.largest_component.vertices, 5);
  EXPECT_GT(quality.largest_component.algebraic_connectivity, 0);
  EXPECT_EQ(services_.quality().quality("lab"), quality);
  services_.upload("lab", "more", photo_jpeg(1, 5));
  EXPECT_EQ(services_.quality().quality("lab").vertices, 7);  // the remembered answer is not given for a changed map
}

TEST_F(DrivenMap, RoutesLeadThroughConfirmedEdges) {
  const contract::Route route = server::find_route(services_.store(), "lab", 0, 4);
  ASSERT_GE(route.vertices.size(), 2u);
  EXPECT_EQ(route.vertices.front(), 0);
  EXPECT_EQ(route.vertices.back(), 4);
  ASSERT_EQ(route.edges.size() + 1, route.vertices.size());
  std::int64_t weakest = INT64_MAX;
  for (std::size_t i = 0; i < route.edges.size(); ++i) {
    EXPECT_EQ(std::minmax(route.vertices[i], route.vertices[i + 1]), std::minmax(route.edges[i].u, route.edges[i].v));
    weakest = std::min<std::int64_t>(weakest, route.edges[i].inliers);
  }
  EXPECT_EQ(route.min_inliers, weakest);
  EXPECT_EQ(code_of([&] { server::find_route(services_.store(), "lab", 0, 5); }), "no_route");
  EXPECT_EQ(code_of([&] { server::find_route(services_.store(), "lab", 0, 99); }), "no_such_vertex");
  EXPECT_EQ(server::find_route(services_.store(), "lab", 3, 3).min_inliers, std::nullopt);
}

TEST_F(DrivenMap, ADeletedMapIsGoneAndItsNameFree) {
  services_.maps().remove("lab");
  EXPECT_EQ(code_of([&] { services_.maps().get("lab"); }), "no_such_map");
  services_.create_map("lab");
  EXPECT_EQ(services_.maps().get("lab").vertices, 0);
  EXPECT_EQ(services_.upload("lab", "step-0", photo_jpeg(1, 3)).upload.vertex, 0);
}

}  // namespace
}  // namespace mapweld::test
