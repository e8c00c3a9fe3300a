// The documents against the examples of docs/http-api.md: what is read and written back is the same document.
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "client/contract/graph.h"
#include "client/contract/image.h"
#include "client/contract/map.h"
#include "client/contract/merge.h"
#include "client/contract/page.h"
#include "client/contract/pair.h"
#include "client/contract/problem_document.h"
#include "client/contract/text.h"
#include "client/contract/vocabulary.h"

namespace mapweld::contract {
namespace {

// Reads `text` as a T and writes it again: nothing of it may be lost, added or reordered.
template <class T>
void expect_round_trip(const char* text) {
  const Json document = parse_json(text);
  const T read = document.get<T>();
  EXPECT_EQ(Json(read).dump(), document.dump());
  EXPECT_EQ(to_text(read), document.dump());
  EXPECT_EQ(Json(read).get<T>(), read);
}

TEST(Documents, MapHasTheShapeOfThePage) {
  expect_round_trip<Map>(R"({"name":"lab-a","kind":"map","vocabulary":"indoor-50k","vertices":1356,"edges":9121,
    "edge_counts":{"verified":9240,"confirmed":9121},"ignored":40,"uuid":"7d444840-9dc0-11d1-b245-5ffdce74fad2",
    "parameters":{"max_features":500,"min_votes":12,"min_inliers":12,"max_inliers":150,"verify_top":20,"votes":"min",
                  "store_images":"full"},
    "labels":{"robot":"p3at-1"},"static_share":0.12,"members":[],"created_at":"2026-11-23T10:00:00Z","revision":1396})");
}

TEST(Documents, MergedMapNamesItsMembersAndItsMerge) {
  const char* text = R"({"name":"lab","kind":"merged","vocabulary":"indoor-50k","vertices":1966,"edges":11021,
    "edge_counts":{"verified":12040,"confirmed":11021},"ignored":0,"uuid":"7d444840-9dc0-11d1-b245-5ffdce74fad3","parameters":{},"labels":{},
    "static_share":0.0,"members":[{"map":"lab-a","watermark":1356},{"map":"lab-b","watermark":610}],"merge":1,
    "created_at":"2026-11-23T10:00:00Z","revision":3})";
  expect_round_trip<Map>(text);
  const auto map = parse_json(text).get<Map>();
  EXPECT_EQ(map.members, (std::vector<MapMember>{{"lab-a", 1356}, {"lab-b", 610}}));
  EXPECT_EQ(map.merge, 1);
}

TEST(Documents, VertexHasTheShapeOfThePage) {
  expect_round_trip<Vertex>(R"({"vertex":812,"name":"000812.jpg","width_px":320,"height_px":240,"features":431,
    "degree":7,"captured_at":null,"sequence":"run-1","index":812,"sha256":"ab12","camera":null,"map":"lab-a",
    "member_vertex":812})");
}

TEST(Documents, PairHasTheShapesOfThePage) {
  expect_round_trip<Pair>(
      R"({"u":12,"v":71,"map":"lab","merge":1,"votes":29,"matches":41,"inliers":24,"verdict":"accepted","reason":null,
    "confirmed":true,"confidence":0.998,"min_confidence":0.9,
    "evidence":[{"name":"rare_matches","value":17.0,"weight":3.5,"says":"matches on things that are nowhere else"},
                {"name":"shared_view","value":0.25,"weight":null,"says":""}],
    "kind":"fundamental","log10_false_alarms":-46.7,
    "inlier_matches":[{"u":{"x_px":181.5,"y_px":92.125},"v":{"x_px":96.25,"y_px":88.875}}]})");
  expect_round_trip<Pair>(
      R"({"u":12,"v":90,"map":"lab","merge":1,"votes":3,"matches":null,"inliers":null,"verdict":"not_candidate",
    "reason":"no_candidate","confirmed":null,"confidence":null})");
}

TEST(Documents, UploadHasTheShapesOfThePage) {
  const char* inserted = R"({"outcome":"inserted","vertex":123,"name":"000123.jpg","features":431,
    "edges":[{"vertex":122,"votes":188,"inliers":96,"confirmed":true,"confidence":null}],"reason":null,"took_ms":31.4})";
  expect_round_trip<Upload>(inserted);
  expect_round_trip<Upload>(R"({"outcome":"inserted","vertex":0,"name":"0","features":0,"edges":[],
    "reason":"too_few_features","took_ms":3.5})");
  const char* ignored = R"({"outcome":"ignored","name":"000124.jpg","features":440,"reason":"too_similar",
    "similar_to":122,"inliers":240,"took_ms":29.0})";
  expect_round_trip<Upload>(ignored);
  EXPECT_FALSE(Json(parse_json(ignored).get<Upload>()).contains("vertex"));
  EXPECT_FALSE(Json(parse_json(inserted).get<Upload>()).contains("similar_to"));
}

TEST(Documents, BatchHoldsAnOutcomeOrAProblemPerPartInOrder) {
  const char* text = R"({"items":[
    {"outcome":"inserted","vertex":1,"name":"a.jpg","features":4,"edges":[],"reason":"no_candidate","took_ms":2.5},
    {"type":"urn:mapweld:problem:undecodable_image","title":"t","status":422,"detail":"d","code":"undecodable_image",
     "request_id":"r"}]})";
  expect_round_trip<Batch>(text);
  const auto batch = parse_json(text).get<Batch>();
  ASSERT_EQ(batch.items.size(), 2U);
  EXPECT_EQ(std::get<Upload>(batch.items[0]).name, "a.jpg");
  EXPECT_EQ(std::get<Problem>(batch.items[1]).code, "undecodable_image");
  EXPECT_THROW(parse_json(R"({"items":7})").get<Batch>(), ContractError);
}

TEST(Documents, IgnoredImageRoundTrips) {
  expect_round_trip<IgnoredImage>(R"({"name":"000124.jpg","reason":"too_similar","similar_to":122,"inliers":240,
    "features":440,"captured_at":null,"sequence":null,"index":null,"sha256":"ab"})");
}

TEST(Documents, LocalizationHasTheShapeOfThePage) {
  expect_round_trip<Localization>(R"({"status":"localized","reason":null,"took_ms":23.1,
    "funnel":{"features":455,"known_words":301,"candidates":37,"verified":9,"best_inliers":61,"needed_inliers":12},
    "matches":[{"vertex":812,"map":"lab-a","member_vertex":812,"name":"000812.jpg","votes":143,"inliers":61,
                "verified":true}]})");
}

TEST(Documents, GraphHasTheShapeOfThePage) {
  expect_round_trip<Graph>(R"({"vertices":[],"edges":[
    {"u":3,"v":9,"kind":"inner","votes":88,"inliers":41,"log10_false_alarms":-22.5,"confirmed":true,"confidence":null,
     "merge":null},
    {"u":3,"v":1400,"kind":"inter","votes":80,"inliers":31,"log10_false_alarms":-12.5,"confirmed":false,"confidence":0.25,
     "reason":"unsupported","merge":1}]})");
}

TEST(Documents, QualityHasTheShapeOfThePage) {
  expect_round_trip<Quality>(
      R"({"vertices":1966,"edges":9121,"edge_counts":{"verified":9240,"confirmed":9121},"components":3,"algebraic_connectivity":0.0,
    "weighted_algebraic_connectivity":0.0,"largest_component":{"vertices":1960,"algebraic_connectivity":0.0131},
    "min_degree":0,"edge_connectivity":0,
    "joined":[{"map":"lab-a","vertices":320},{"map":"lab-b","vertices":301}],"independent_joins":288})");
}

TEST(Documents, SubmissionHasTheShapeOfThePage) {
  const Json document = parse_json(R"({"maps":["lab-a","lab-b"],"name":"lab","method":"quickconnect","seed":7,
    "parameters":{"min_votes":12,"min_inliers":12,"max_false_alarms":1e-15,"votes":"product","alias_guard":false,
                  "min_confidence":0.95,"serves_certificate":true},
    "budget":{"seconds":1.5,"verifications":null,"edges":null,"fraction_of_maximum":null,"certified":false}})");
  const auto submit = read_request<SubmitMerge>(document);
  EXPECT_NO_THROW(check(submit));
  EXPECT_EQ(submit.maps, (std::vector<std::string>{"lab-a", "lab-b"}));
  EXPECT_EQ(submit.seed, 7);
  EXPECT_EQ(submit.parameters->votes, "product");
  EXPECT_EQ(submit.parameters->max_false_alarms, 1e-15);
  EXPECT_EQ(submit.parameters->min_confidence, 0.95);
  EXPECT_EQ(submit.parameters->serves_certificate, true);
  EXPECT_EQ(submit.budget->seconds, 1.5);
  EXPECT_EQ(submit.budget->verifications, std::nullopt);
  EXPECT_EQ(Json(submit).get<SubmitMerge>(), submit);
}

TEST(Documents, MergeHasTheFieldsOfThePage) {
  const Json document = parse_json(R"({"id":1,"state":"running","method":"quickconnect","maps":["lab-a","lab-b"],
    "map":"lab","seed":7,"phase":"exploration","step":18231,"words":{"done":9120,"total":31877},
    "candidates":{"known":5120,"verified":412,"accepted":247},"edges":247,
    "edge_counts":{"verified":247,"confirmed":201},"revoked":2,"components":3,"algebraic_connectivity":0.0,
    "largest_component":{"vertices":1960,"algebraic_connectivity":0.0131},
    "joined":[{"map":"lab-a","vertices":3}],"independent_joins":288,"certified_fraction":null,"estimated_fraction":null,
    "joinable_vertices":null,"elapsed_s":1.5,"budget":{"seconds":1.5},"eta_s":12.0,
    "checkpoint":{"step":18176,"age_s":0.4},"stop_reason":null,"error":null,
    "links":{"self":"/v1/merges/1","map":"/v1/maps/lab"}})");
  const Json written(document.get<Merge>());
  for (const auto& [key, value] : document.items()) EXPECT_EQ(written.at(key).dump(), value.dump()) << key;
}

TEST(Documents, CurvePointAndMergeEdgeHaveTheShapesOfThePage) {
  expect_round_trip<CurvePoint>(R"({"step":512,"elapsed_s":0.25,"verifications":40,"edges":12,
    "edge_counts":{"verified":12,"confirmed":9},"components":4,
    "algebraic_connectivity":0.0,"largest_component":{"vertices":1960,"algebraic_connectivity":0.0131},
    "certified_fraction":null,"phase":"exploration"})");
  expect_round_trip<MergeEdge>(R"({"u":1,"v":1400,"votes":91,"inliers":44,"verifications":17,"elapsed_s":0.125,
    "confirmed":false,"confidence":0.5,"reason":"ambiguous"})");
  EXPECT_EQ(Json(parse_json(R"({"edges":12,"edge_counts":null})").get<CurvePoint>()).at("edge_counts"), nullptr);
}

TEST(Documents, VocabularyAndProblemRoundTrip) {
  expect_round_trip<Vocabulary>(R"({"name":"indoor-50k","words":50000,"dimension":128,"descriptor":"sift",
    "sha256":"ab","index":"hnsw","created_at":"2026-11-23T10:00:00Z"})");
  expect_round_trip<Problem>(R"({"type":"urn:mapweld:problem:no_such_map","title":"There is no map of this name",
    "status":404,"detail":"There is no map \"lab\".","code":"no_such_map","request_id":"9f"})");
}

TEST(Documents, PagesSayNullOnTheLastOne) {
  const auto page = parse_json(R"({"items":[{"map":"a","watermark":3}],"next_cursor":null})").get<Page<MapMember>>();
  EXPECT_EQ(page.items, (std::vector<MapMember>{{"a", 3}}));
  EXPECT_EQ(page.next_cursor, std::nullopt);
  EXPECT_EQ(Json(page).dump(), R"({"items":[{"map":"a","watermark":3}],"next_cursor":null})");
}

TEST(Documents, AnswersMaySayMoreOrLess) {
  const auto map = parse_json(R"({"name":"lab","colour":"red","parameters":{"new":1}})").get<Map>();
  EXPECT_EQ(map.name, "lab");
  EXPECT_EQ(map.vertices, 0);
  EXPECT_THROW(parse_json(R"({"name":5})").get<Map>(), ContractError);
}

TEST(Documents, TheTextOfADocumentIsThatOfItsJsonWhateverStandsInIt) {
  const std::string_view bytes[] = {"",
                                    "a.jpg",
                                    "a \"quoted\" \\ name",
                                    "\x01\x1f\t\n\x7f",
                                    "Gr\xc3\xbc\xc3\x9f"
                                    "e \xf0\x9f\xa4\x96",
                                    "broken \xff\xc3",
                                    "</script>"};
  for (const std::string_view text : bytes) {
    Map map;
    map.name = text;
    map.labels = {{std::string(text), "value"}, {"key", std::string(text)}};
    map.vertices = std::numeric_limits<std::int64_t>::min();
    map.revision = std::numeric_limits<std::int64_t>::max();
    for (const double share : {0.0, 0.1, -1.5e300, 5e-324, std::nan("")}) {
      map.static_share = share;
      EXPECT_EQ(to_text(map), dump(Json(map)));
    }
  }
  Page<Vertex> page;
  EXPECT_EQ(to_text(page), dump(Json(page)));
  page.items.resize(3);
  page.items[1].camera = Camera{};
  page.next_cursor = "2";
  EXPECT_EQ(to_text(page), dump(Json(page)));
}

}  // namespace
}  // namespace mapweld::contract
