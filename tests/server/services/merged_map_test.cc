// Merged maps through the services: views over their members.
#include <algorithm>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "client/contract/problem.h"
#include "schema/blobs/appearance_blob.h"
#include "schema/maps/edge_store.h"
#include "schema/maps/map_store.h"
#include "schema/maps/vertex_store.h"
#include "schema/store_check.h"
#include "server/maps/map_judge.h"
#include "server/services/graph_export.h"
#include "tests/server/support/services_under_test.h"
#include "tests/server/support/test_photos.h"

namespace mapweld::test {
namespace {

using namespace std::chrono_literals;

class MergedMap : public ::testing::Test {
 protected:
  // Two robots on one wall, four steps each, the second two steps further; and one on a wall of its own.
  MergedMap() {
    for (const char* name : {"a", "b", "c"}) services_.create_map(name);
    for (int step = 0; step < 4; ++step) {
      services_.upload("a", "a-" + std::to_string(step), photo_jpeg(1, step));
      services_.upload("b", "b-" + std::to_string(step), photo_jpeg(1, step + 2));
      services_.upload("c", "c-" + std::to_string(step), photo_jpeg(7, step));
    }
  }

  contract::SubmitMerge request(std::vector<std::string> maps, const std::string& name) {
    contract::SubmitMerge submit;
    submit.maps = std::move(maps);
    submit.name = name;
    return submit;
  }

  contract::Merge finish(const contract::SubmitMerge& submit) {
    const contract::Merge merge = services_.merges().submit(submit);
    services_.jobs().wait(merge.id, 30s);
    return services_.merges().get(merge.id);
  }

  contract::Localization localize(const std::string& map, const std::string& image, std::size_t limit = 5) {
    server::LocalizeQuery query;
    query.image = {reinterpret_cast<const std::uint8_t*>(image.data()), image.size()};
    query.limit = limit;
    return services_.localization().localize(map, query);
  }

  ServicesUnderTest services_;
};

TEST_F(MergedMap, ShowsItsMembersUnderNumbersOfItsOwn) {
  const contract::Merge merge = finish(request({"a", "b"}, "ab"));
  EXPECT_EQ(merge.state, "completed");
  EXPECT_GT(merge.edges, 0);
  EXPECT_EQ(merge.links.map, "/v1/maps/ab");
  EXPECT_FALSE(merge.created_at.empty());
  const contract::Map map = services_.maps().get("ab");
  EXPECT_EQ(map.kind, "merged");
  EXPECT_EQ(map.merge, merge.id);
  EXPECT_EQ(map.vertices, 8);
  EXPECT_EQ(map.edges, services_.maps().get("a").edges + services_.maps().get("b").edges + merge.edges);
  EXPECT_EQ(map.members, (std::vector<contract::MapMember>{{"a", 4}, {"b", 4}}));
  const contract::Vertex vertex = services_.maps().vertex("ab", 5);
  EXPECT_EQ(vertex.map, "b");
  EXPECT_EQ(vertex.member_vertex, 1);
  EXPECT_EQ(vertex.name, "b-1");
  EXPECT_EQ(services_.maps().image("ab", 5).bytes, photo_jpeg(1, 3));
  const auto inter = services_.maps().edges("ab", {0, true}, {1000, std::nullopt});
  EXPECT_EQ(static_cast<std::int64_t>(inter.items.size()), merge.edges);
  for (const contract::Edge& edge : inter.items) {
    EXPECT_LT(edge.u, 4);
    EXPECT_GE(edge.v, 4);
    EXPECT_EQ(edge.merge, merge.id);
  }
}

// As a version stored it that knew no signatures.
void forget_signatures(Store& store, const std::string& name) {
  WriteTransaction db = store.write();
  const MapRow map = find_map(db, name).value();
  for (std::uint32_t v = 0; v < map.vertices; ++v) {
    AppearanceVector image = load_appearances(db, map.id, map.vocabulary, VertexId{v});
    for (Appearance& a : image.appearances) a.signature = {};
    db.prepare("UPDATE appearances SET bytes = ? WHERE map = ? AND vertex = ?")
        .bind_all(std::span<const std::uint8_t>(blobs::encode_appearances(image)), map.id, VertexId{v})
        .run();
  }
  db.commit();
}

TEST_F(MergedMap, IsVotedForBySignaturesWhereAllMembersHaveThem) {
  const contract::Merge usual = finish(request({"a", "b"}, "ab"));
  EXPECT_EQ(usual.parameters.votes, "signatures");
  EXPECT_EQ(usual.parameters.min_votes, 3);
  forget_signatures(services_.store(), "b");
  const contract::Merge by_words = finish(request({"a", "b"}, "ab-words"));
  EXPECT_EQ(by_words.parameters.votes, "min");
  EXPECT_EQ(by_words.parameters.min_votes, 10);
  EXPECT_GT(by_words.edges, 0);
  EXPECT_EQ(finish(request({"ab", "c"}, "abc")).parameters.votes, "min") << "a member's member has none";
  contract::SubmitMerge asked = request({"a", "b"}, "ab-signatures");
  asked.parameters.emplace().votes = "signatures";
  const contract::Merge as_asked = finish(asked);
  EXPECT_EQ(as_asked.parameters.votes, "signatures");
  EXPECT_EQ(as_asked.parameters.min_votes, 3);
  EXPECT_EQ(as_asked.state, "completed");
}

TEST_F(MergedMap, IsLocalizedInAtOnceAndQualityIsThatOfTheMerge) {
  // The merge judges its members' edges by itself, the maps are judged in the background.
  for (const char* name : {"a", "b"}) {
    judge_map(services_.store(), services_.cache(), find_map(services_.store().read(), name).value());
  }
  const contract::Merge merge = finish(request({"a", "b"}, "ab"));
  // Seen by b alone, in b's own steps and in neither.
  const contract::Localization found = localize("ab", photo_jpeg(1, 5));
  EXPECT_EQ(found.status, "localized");
  EXPECT_EQ(found.matches.at(0).map, "b");
  EXPECT_EQ(found.matches.at(0).vertex, 7);
  EXPECT_EQ(found.matches.at(0).member_vertex, 3);
  EXPECT_EQ(found.matches.at(0).name, "b-3");
  EXPECT_EQ(localize("ab", photo_jpeg(5, 0)).status, "not_found");
  const contract::Quality quality = services_.quality().quality("ab");
  EXPECT_EQ(quality.joined, merge.joined);
  EXPECT_EQ(quality.independent_joins, merge.independent_joins);
  EXPECT_EQ(quality.components, merge.components);
  EXPECT_NEAR(quality.algebraic_connectivity, merge.algebraic_connectivity, 1e-9);
}

TEST_F(MergedMap, NothingOfAMemberShowsBeyondItsWatermark) {
  finish(request({"a", "b"}, "ab"));
  const contract::Map before = services_.maps().get("ab");
  const contract::Quality quality = services_.quality().quality("ab");
  const contract::Localization found = localize("ab", photo_jpeg(1, 7));
  services_.upload("b", "b-4", photo_jpeg(1, 6));
  services_.upload("b", "b-5", photo_jpeg(1, 7));
  EXPECT_EQ(services_.maps().get("b").vertices, 6);
  EXPECT_EQ(services_.maps().get("ab").vertices, before.vertices);
  EXPECT_EQ(services_.maps().get("ab").edges, before.edges);
  EXPECT_EQ(services_.quality().quality("ab"), quality);
  EXPECT_EQ(code_of([&] { services_.maps().vertex("ab", 8); }), "no_such_vertex");
  contract::Localization again = localize("ab", photo_jpeg(1, 7));
  again.took_ms = found.took_ms;
  EXPECT_EQ(again, found);
  EXPECT_EQ(localize("b", photo_jpeg(1, 7)).matches.at(0).vertex, 5);
}

TEST_F(MergedMap, EverythingFollowsWhatIsThoughtOfAMembersInnerEdges) {
  finish(request({"a", "b"}, "ab"));
  const contract::Quality before = services_.quality().quality("ab");
  const contract::Map map_before = services_.maps().get("ab");
  const std::int64_t degree_before = services_.maps().vertex("ab", 0).degree;
  MapId a{};
  std::vector<JudgedEdge> edges;
  {
    WriteTransaction db = services_.store().write();
    a = find_map(db, "a")->id;
    edges = load_judgements(db, a);
    ASSERT_GT(edges.size(), 1u);
    ASSERT_EQ(edges.front().u, VertexId{0});
    edges.resize(1);
    edges.front().judgement = {0.125, Reason::kUnsupported, {}};
    set_judgements(db, a, edges);
    db.commit();
  }
  services_.cache().follow_judgements(a, edges);
  const contract::Quality after = services_.quality().quality("ab");
  EXPECT_EQ(after.edges, before.edges - 1);
  EXPECT_EQ(after.edge_counts.verified, before.edge_counts.verified);
  EXPECT_EQ(after.edge_counts.confirmed, before.edge_counts.confirmed - 1);
  const contract::Map map = services_.maps().get("ab");
  EXPECT_EQ(map.edges, map_before.edges - 1);
  EXPECT_EQ(map.edge_counts.verified, map_before.edge_counts.verified);
  EXPECT_EQ(services_.maps().get("a").edge_counts.confirmed, services_.maps().get("a").edge_counts.verified - 1);
  EXPECT_EQ(services_.maps().vertex("ab", 0).degree, degree_before - 1);
  const auto doubted = services_.maps().edges("ab", {0, false, false}, {1000, std::nullopt}).items;
  ASSERT_EQ(doubted.size(), 1u);
  EXPECT_EQ(doubted.front().confidence, 0.125);
  EXPECT_EQ(doubted.front().reason, "unsupported");
  // What a repeated upload says of the edge is how it stands now.
  const auto repeated = services_.upload("a", "a-" + std::to_string(to_index(edges.front().v)),
                                         photo_jpeg(1, static_cast<int>(to_index(edges.front().v))));
  const auto& told = repeated.upload.edges.value();
  const auto edge = std::ranges::find(told, std::int64_t{0}, &contract::UploadEdge::vertex);
  ASSERT_NE(edge, told.end());
  EXPECT_FALSE(edge->confirmed);
  EXPECT_EQ(edge->confidence, 0.125);
  // A merge of the map rests on what is confirmed.
  const contract::Merge later = finish(request({"a", "c"}, "ac"));
  EXPECT_EQ(services_.quality().quality("ac").edges,
            services_.maps().get("a").edges + services_.maps().get("c").edges + later.edge_counts.confirmed);
}

TEST_F(MergedMap, RefusesUploadsAndDeletionOfItsMembers) {
  finish(request({"a", "b"}, "ab"));
  const std::string stored = dump_store(services_.store());
  EXPECT_EQ(code_of([&] { services_.upload("ab", "x", photo_jpeg(1, 9)); }), "map_is_merged");
  EXPECT_EQ(code_of([&] { services_.maps().remove("a"); }), "map_in_use");
  EXPECT_EQ(dump_store(services_.store()), stored);
}

TEST_F(MergedMap, BrokenSubmissionsChangeNothing) {
  services_.vocabularies().add("other-words", small_vocabulary().serialize());
  contract::CreateMap foreign;
  foreign.name = "foreign";
  foreign.vocabulary = "other-words";
  services_.maps().create(foreign);
  const std::string stored = dump_store(services_.store());
  const auto code = [&](const contract::SubmitMerge& submit) {
    return code_of([&] { services_.merges().submit(submit); });
  };
  EXPECT_EQ(code(request({"a"}, "x")), "too_few_members");
  EXPECT_EQ(code(request({"a", "a"}, "x")), "duplicate_member");
  EXPECT_EQ(code(request({"a", "nope"}, "x")), "no_such_map");
  EXPECT_EQ(code(request({"a", "b"}, "c")), "name_taken");
  EXPECT_EQ(code(request({"a", "b"}, "no/slug")), "invalid_name");
  EXPECT_EQ(code(request({"a", "foreign"}, "x")), "vocabulary_mismatch");
  contract::SubmitMerge submit = request({"a", "b"}, "x");
  submit.method = "magic";
  EXPECT_EQ(code(submit), "unknown_method");
  for (const double seconds : {0.0, -1.0, std::numeric_limits<double>::infinity(), std::nan("")}) {
    submit = request({"a", "b"}, "x");
    submit.budget.emplace();
    submit.budget->seconds = seconds;
    EXPECT_EQ(code(submit), "invalid_budget") << seconds;
  }
  submit = request({"a", "b"}, "x");
  submit.budget.emplace();
  submit.budget->verifications = -5;
  EXPECT_EQ(code(submit), "invalid_budget");
  EXPECT_EQ(dump_store(services_.store()), stored);
  EXPECT_EQ(code_of([&] { services_.merges().get(99); }), "no_such_merge");
  EXPECT_EQ(code_of([&] { services_.merges().pause(99); }), "no_such_merge");
  EXPECT_EQ(code_of([&] { services_.merges().list("sleeping", {}); }), "invalid_parameter");
}

TEST_F(MergedMap, DeletingItLeavesTheMembersAsTheyWere) {
  const std::string stored = dump_store(services_.store());
  const contract::Merge merge = finish(request({"a", "b"}, "ab"));
  localize("ab", photo_jpeg(1, 3));
  services_.maps().remove("ab");
  EXPECT_EQ(code_of([&] { services_.merges().get(merge.id); }), "no_such_merge");
  EXPECT_EQ(code_of([&] { localize("ab", photo_jpeg(1, 3)); }), "no_such_map");
  // The verifier's version stays on record, and numbers are not given twice; everything else is as before.
  const contract::Map a = services_.maps().get("a");
  EXPECT_EQ(a.vertices, 4);
  EXPECT_TRUE(check_store(services_.store().read()).findings.empty());
  const contract::Merge second = finish(request({"a", "b"}, "ab"));
  EXPECT_GT(second.id, merge.id);
  EXPECT_EQ(second.edges, merge.edges);
}

TEST_F(MergedMap, MayBeAMemberItself) {
  finish(request({"a", "c"}, "ac"));
  const contract::Merge merge = finish(request({"ac", "b"}, "acb"));
  EXPECT_EQ(merge.state, "completed");
  EXPECT_EQ(services_.maps().get("acb").vertices, 12);
  EXPECT_EQ(services_.maps().vertex("acb", 6).map, "c");
  EXPECT_EQ(services_.maps().vertex("acb", 9).map, "b");
  const contract::Localization found = localize("acb", photo_jpeg(1, 5));
  EXPECT_EQ(found.status, "localized");
  EXPECT_EQ(found.matches.at(0).vertex, 11);
  EXPECT_EQ(localize("acb", photo_jpeg(7, 1)).matches.at(0).vertex, 5);
  EXPECT_EQ(code_of([&] { services_.maps().remove("ac"); }), "map_in_use");
  const contract::Quality quality = services_.quality().quality("acb");
  EXPECT_EQ(quality.joined.size(), 2u);
  EXPECT_EQ(quality.joined[0].map, "ac");
}

TEST_F(MergedMap, AnswersTheSameWhenItsMembersDoNotFitIntoMemory) {
  finish(request({"a", "b"}, "ab"));
  std::vector<contract::Localization> in_memory;
  for (int step = 0; step < 7; ++step) in_memory.push_back(localize("ab", photo_jpeg(1, step), 1000));
  ServicesOptions options;
  options.cache_bytes = 0;
  server::Metrics metrics;
  server::MapCache cache(services_.store(), 0);
  server::MapOpener opener(services_.store(), cache);
  server::WorkerPool workers(1);
  server::LocalDecoder decoder;
  server::LocalizeService from_store(services_.store(), opener, services_.vocabularies(), workers, decoder, metrics);
  for (int step = 0; step < 7; ++step) {
    const std::string image = photo_jpeg(1, step);
    server::LocalizeQuery query;
    query.image = {reinterpret_cast<const std::uint8_t*>(image.data()), image.size()};
    query.limit = 1000;
    contract::Localization found = from_store.localize("ab", query);
    found.took_ms = in_memory[static_cast<std::size_t>(step)].took_ms;
    EXPECT_EQ(found, in_memory[static_cast<std::size_t>(step)]);
  }
}

}  // namespace
}  // namespace mapweld::test
