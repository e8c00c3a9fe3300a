#include "schema/maps/edge_store.h"

#include <algorithm>
#include <set>
#include <stdexcept>
#include <tuple>

#include <gtest/gtest.h>

#include "schema/merges/merge_store.h"
#include "tests/support/temp_store.h"

namespace mapweld {
namespace {

using test::Random;
using test::TempStore;

// Two plain maps with random inner edges, merged with random inter edges; the model keeps what was inserted.
class EdgeStoreTest : public testing::Test {
 protected:
  using Key = std::tuple<std::uint32_t, std::uint32_t, std::uint32_t>;  // u, v, inliers

  void SetUp() override {
    fill(a_, 12, model_a_);
    fill(b_, 9, model_b_);
    WriteTransaction db = store_.write();
    merged_ = insert_merged_map(db, test::new_map("ab", vocabulary_), std::vector{a_, b_});
    job_ = insert_merge(db, {merged_, "quickconnect", 7, "{}", "{}", test::at(3)});
    std::vector<NewEdge> edges;
    for (std::uint32_t v = 12; v < 21; ++v) edges.push_back(edge(static_cast<std::uint32_t>(random_.below(12)), v));
    insert_edges(db, merged_, edges, test::test_verifier(db), job_);
    for (const NewEdge& e : edges) {
      model_merged_.push_back({to_index(e.u), to_index(e.v), e.verification.inliers});
    }
    db.commit();
    // Beyond the watermark: does not show through.
    add_vertex(a_, 12, {edge(0, 12)});
  }

  NewEdge edge(std::uint32_t u, std::uint32_t v) {
    NewEdge e;
    e.u = VertexId{u};
    e.v = VertexId{v};
    e.votes = static_cast<std::uint32_t>(random_.below(500));
    e.verification = test::random_verification(random_, 12 + static_cast<int>(random_.below(100)), 400, 400);
    if (random_.chance(0.8)) e.judgement = random_judgement();
    e.verifications = random_.below(1'000);
    e.elapsed_s = random_.unit();
    return e;
  }

  EdgeJudgement random_judgement() {
    EdgeJudgement judgement{random_.unit(), random_.chance(0.7) ? Reason::kNone : Reason::kAmbiguous, {}};
    if (random_.chance(0.7)) judgement.made_of = {{"rare_matches", 31, 2.5}, {"spread_diagonals", 0.25, std::nullopt}};
    return judgement;
  }

  void add_vertex(MapId map, std::uint32_t v, const std::vector<NewEdge>& edges) {
    WriteTransaction db = store_.write();
    insert_vertex(db, map, vocabulary_, test::new_image(std::to_string(v), {}), {320, 240, {}}, edges,
                  test::test_verifier(db));
    db.commit();
  }

  void fill(MapId map, std::uint32_t vertices, std::vector<Key>& model) {
    for (std::uint32_t v = 0; v < vertices; ++v) {
      std::vector<NewEdge> edges;
      for (std::uint32_t u = 0; u < v; ++u) {
        if (random_.chance(0.4)) edges.push_back(edge(u, v));
      }
      std::ranges::reverse(edges);
      add_vertex(map, v, edges);
      for (const NewEdge& e : edges) model.push_back({to_index(e.u), v, e.verification.inliers});
    }
  }

  // What the merged map shows, in order.
  std::vector<Key> shown() const {
    std::vector<Key> all = model_merged_;
    all.insert(all.end(), model_a_.begin(), model_a_.end());
    for (const auto& [u, v, inliers] : model_b_) all.push_back({u + 12, v + 12, inliers});
    return all;
  }

  static Key key(const EdgeRow& e) { return {to_index(e.u), to_index(e.v), e.inliers}; }

  TempStore store_;
  Random random_{31};
  VocabularyId vocabulary_ = test::add_vocabulary(store_);
  MapId a_ = test::add_map(store_, "a", vocabulary_);
  MapId b_ = test::add_map(store_, "b", vocabulary_);
  MapId merged_{};
  JobId job_{};
  std::vector<Key> model_a_, model_b_, model_merged_;
};

TEST_F(EdgeStoreTest, AMergedMapShowsInterEdgesAndInnerOnesBelowTheWatermarks) {
  const ReadTransaction reader = store_.read();
  const MapLayout layout = load_layout(reader, merged_);
  for (const std::size_t limit : {1UL, 2UL, 7UL, 1'000UL}) {
    std::vector<Key> read;
    EdgeCursor after;
    for (;;) {
      const EdgePage page = list_edges(reader, layout, {}, limit, after);
      EXPECT_LE(page.edges.size(), limit);
      for (const EdgeRow& e : page.edges) read.push_back(key(e));
      if (!page.next) break;
      after = *page.next;
      EXPECT_FALSE(page.edges.empty());
    }
    EXPECT_EQ(read, shown());
  }
  EXPECT_EQ(count_edges(reader, layout), shown().size());
  const std::vector<Edge> edges = load_edges(reader, layout);
  ASSERT_EQ(edges.size(), shown().size());
  for (std::size_t i = 0; i < edges.size(); ++i) {
    EXPECT_EQ((Key{to_index(edges[i].u), to_index(edges[i].v), edges[i].weight}), shown()[i]);
  }
}

TEST_F(EdgeStoreTest, FiltersChooseAmongTheSameEdges) {
  const ReadTransaction reader = store_.read();
  const MapLayout layout = load_layout(reader, merged_);
  const std::vector<EdgeRow> all = list_edges(reader, layout, {}, 1'000).edges;
  for (const std::uint32_t min_inliers : {0U, 50U, 500U}) {
    for (const std::optional<bool> inter : {std::optional<bool>(), std::optional(true), std::optional(false)}) {
      for (const std::optional<bool> confirmed : {std::optional<bool>(), std::optional(true), std::optional(false)}) {
        std::vector<Key> expected;
        for (const EdgeRow& e : all) {
          if (e.inliers >= min_inliers && (!inter || e.inter == *inter) && (!confirmed || e.confirmed == *confirmed)) {
            expected.push_back(key(e));
          }
        }
        const EdgeFilter filter{min_inliers, inter, confirmed};
        std::vector<Key> read;
        for (const EdgeRow& e : list_edges(reader, layout, filter, 1'000).edges) read.push_back(key(e));
        EXPECT_EQ(read, expected);
        EXPECT_EQ(count_edges(reader, layout, filter), expected.size());
        EXPECT_EQ(load_edges(reader, layout, filter).size(), expected.size());
      }
    }
  }
}

TEST_F(EdgeStoreTest, TheEdgesAtAVertexAreThoseThatTouchIt) {
  const ReadTransaction reader = store_.read();
  const MapLayout layout = load_layout(reader, merged_);
  const std::vector<Key> all = shown();
  for (std::uint32_t vertex = 0; vertex < layout.vertices(); ++vertex) {
    std::vector<Key> expected;
    std::ranges::copy_if(all, std::back_inserter(expected),
                         [&](const Key& k) { return std::get<0>(k) == vertex || std::get<1>(k) == vertex; });
    std::vector<Key> read;
    for (const EdgeRow& e : list_edges_at(reader, layout, VertexId{vertex})) read.push_back(key(e));
    EXPECT_EQ(read, expected);
  }
}

TEST_F(EdgeStoreTest, DegreesCountTheConfirmedEdgesThatAreShown) {
  // A merged map of a merged one, whose members have grown since, so that it has pieces of each.
  add_vertex(b_, 9, {edge(3, 9), edge(8, 9)});
  WriteTransaction db = store_.write();
  const MapId c = insert_map(db, test::new_map("c", vocabulary_));
  const MapId outer = insert_merged_map(db, test::new_map("abc", vocabulary_), std::vector{merged_, c});
  db.commit();
  const ReadTransaction reader = store_.read();
  for (const MapId map : {a_, b_, merged_, outer}) {
    const MapLayout layout = load_layout(reader, map);
    std::vector<std::int64_t> expected(layout.vertices());
    const std::vector<EdgeRow> all = list_edges(reader, layout, {}, 1'000).edges;
    for (const EdgeRow& e : all) {
      EXPECT_EQ(find_edge(reader, layout, e.v, e.u)->id, e.id);
      if (!e.confirmed) continue;
      ++expected[to_index(e.u)];
      ++expected[to_index(e.v)];
    }
    EXPECT_TRUE(std::ranges::any_of(all, [](const EdgeRow& e) { return !e.confirmed; }));
    for (std::uint32_t first = 0; first < layout.vertices(); ++first) {
      for (std::uint32_t end = first; end <= layout.vertices(); ++end) {
        EXPECT_EQ(count_confirmed_edges_at(reader, layout, VertexId{first}, end - first),
                  std::vector(expected.begin() + first, expected.begin() + end));
      }
      for (std::uint32_t other = 0; other < layout.vertices(); ++other) {
        const bool has = std::ranges::any_of(all, [&](const EdgeRow& e) {
          return std::minmax(to_index(e.u), to_index(e.v)) == std::minmax(first, other);
        });
        EXPECT_EQ(find_edge(reader, layout, VertexId{first}, VertexId{other}).has_value(), has);
      }
    }
  }
}

TEST_F(EdgeStoreTest, InterEdgesComeInOrderOfInsertionAsTheyStoodThen) {
  const ReadTransaction reader = store_.read();
  const auto first = list_merge_edges(reader, job_, 4);
  auto read = list_merge_edges(reader, job_, 100, first.back().id);
  read.insert(read.begin(), first.begin(), first.end());
  ASSERT_EQ(read.size(), model_merged_.size());
  for (std::size_t i = 0; i < read.size(); ++i) {
    EXPECT_EQ(key(read[i]), model_merged_[i]);
    EXPECT_TRUE(read[i].inter);
    EXPECT_EQ(read[i].job, job_);
    EXPECT_GT(read[i].elapsed_s, 0);
  }
  EXPECT_EQ(find_map(reader, merged_)->edges, model_merged_.size());
}

TEST_F(EdgeStoreTest, TheEvidenceOfAnEdgeComesBackBitForBit) {
  WriteTransaction db = store_.write();
  NewEdge inserted = edge(3, 20);
  inserted.judgement = {
      0.25, Reason::kUnsupported, {{"fullness", 0.125, -1.5}, {"a name of two words", -7, std::nullopt}}};
  const VerifierId verifier = intern_verifier(db, "epipolar-1", R"({"min_inliers":12})");
  EXPECT_EQ(intern_verifier(db, "epipolar-1", R"({"min_inliers":12})"), verifier);
  EXPECT_NE(intern_verifier(db, "epipolar-1", R"({"min_inliers":13})"), verifier);
  db.prepare("DELETE FROM edges WHERE map = ? AND u = 3 AND v = 20").bind(1, merged_).run();
  insert_edges(db, merged_, std::span(&inserted, 1), verifier, job_);
  db.commit();
  const ReadTransaction reader = store_.read();
  const auto row = find_own_edge(reader, merged_, VertexId{20}, VertexId{3});
  ASSERT_TRUE(row);
  const EdgeEvidence evidence = load_edge_evidence(reader, row->id);
  EXPECT_EQ(evidence.verification, inserted.verification);
  EXPECT_EQ(evidence.edge.votes, inserted.votes);
  EXPECT_EQ(evidence.edge.confirmed, inserted.judgement.doubt == Reason::kNone);
  EXPECT_EQ(evidence.edge.doubt, std::string(to_string(inserted.judgement.doubt)));
  EXPECT_EQ(evidence.edge.confidence, inserted.judgement.confidence);
  EXPECT_EQ(evidence.made_of, inserted.judgement.made_of);
  EXPECT_EQ(evidence.edge.verifications, inserted.verifications);
  EXPECT_EQ(evidence.edge.elapsed_s, inserted.elapsed_s);
  EXPECT_EQ(evidence.verifier_version, "epipolar-1");
  EXPECT_EQ(evidence.verifier_parameters, R"({"min_inliers":12})");
  EXPECT_THROW(load_edge_evidence(reader, EdgeId{9'999}), std::out_of_range);
  EXPECT_FALSE(find_own_edge(reader, merged_, VertexId{0}, VertexId{1}));
}

TEST_F(EdgeStoreTest, BrokenEdgesAreRefusedAndLeaveNothing) {
  const auto refused = [&](MapId map, const NewEdge& e, std::optional<JobId> job) {
    WriteTransaction db = store_.write();
    EXPECT_THROW(insert_edges(db, map, std::span(&e, 1), test::test_verifier(db), job), StoreError);
  };
  refused(merged_, edge(5, 5), job_);
  refused(merged_, edge(15, 5), job_);
  refused(merged_, edge(0, 21), job_);  // no such vertex
  refused(merged_, edge(0, 20), std::nullopt);
  refused(a_, edge(0, 1), job_);
  const auto& [u, v, inliers] = model_merged_.front();
  refused(merged_, edge(u, v), job_);  // there already
  EXPECT_EQ(find_map(store_.read(), merged_)->edges, model_merged_.size());
}

TEST_F(EdgeStoreTest, WhatIsThoughtOfEdgesMayChangeInnerOnesToo) {
  for (const MapId map : {merged_, a_}) {
    std::vector<JudgedEdge> model = load_judgements(store_.read(), map);
    ASSERT_GT(model.size(), 8u);
    for (int round = 0; round < 6; ++round) {
      const MapRow before = *find_map(store_.read(), map);
      std::vector<JudgedEdge> changed;
      for (JudgedEdge& edge : model) {
        if (!random_.chance(0.6)) continue;
        edge.judgement = random_.chance(0.8) ? random_judgement() : EdgeJudgement{};
        changed.push_back(edge);
      }
      ASSERT_FALSE(changed.empty());
      WriteTransaction db = store_.write();
      set_judgements(db, map, changed);
      db.commit();
      const ReadTransaction reader = store_.read();
      const std::vector<JudgedEdge> stored = load_judgements(reader, map);
      ASSERT_EQ(stored.size(), model.size());
      std::uint64_t unconfirmed = 0;
      for (std::size_t i = 0; i < model.size(); ++i) {
        EXPECT_EQ(stored[i].judgement, model[i].judgement);
        const auto row = find_own_edge(reader, map, model[i].u, model[i].v);
        EXPECT_EQ(row->confirmed, model[i].judgement.doubt == Reason::kNone);
        EXPECT_EQ(row->confidence, model[i].judgement.confidence);
        if (!row->confirmed) ++unconfirmed;
      }
      const MapRow after = *find_map(reader, map);
      EXPECT_EQ(after.unconfirmed, unconfirmed);
      EXPECT_EQ(after.revision, before.revision + 1);
      EXPECT_EQ(after.judgements, before.judgements + 1);
      EXPECT_EQ(count_edges(reader, load_layout(reader, a_), {.confirmed = false}), find_map(reader, a_)->unconfirmed);
    }
  }
  // What a merge goes on from has the same judgements.
  const std::vector<JudgedEdge> stored = load_judgements(store_.read(), merged_);
  const std::vector<NewEdge> loaded = load_merge_edges(store_.read(), job_);
  ASSERT_EQ(loaded.size(), stored.size());
  for (std::size_t i = 0; i < loaded.size(); ++i) EXPECT_EQ(loaded[i].judgement, stored[i].judgement);
}

TEST_F(EdgeStoreTest, JudgementsThatCannotBeAreRefusedAndChangeNothing) {
  const std::vector<JudgedEdge> before = load_judgements(store_.read(), merged_);
  const MapRow map = *find_map(store_.read(), merged_);
  const auto refused = [&](JudgedEdge edge) {
    WriteTransaction db = store_.write();
    const std::vector<JudgedEdge> edges = {{before.front().u, before.front().v, {0.5, Reason::kNone, {}}}, edge};
    EXPECT_THROW(set_judgements(db, merged_, edges), StoreError);
  };
  const auto [u, v, judgement] = before.back();
  refused({u, v, {1.5, Reason::kNone, {}}});
  refused({u, v, {-0.1, Reason::kUnsupported, {}}});
  refused({u, v, {std::nullopt, Reason::kUnsupported, {}}});  // withheld by nobody
  refused({v, u, {0.5, Reason::kNone, {}}});                  // there is no such edge
  const std::vector<JudgedEdge> after = load_judgements(store_.read(), merged_);
  for (std::size_t i = 0; i < before.size(); ++i) EXPECT_EQ(after[i].judgement, before[i].judgement);
  EXPECT_EQ(find_map(store_.read(), merged_)->revision, map.revision);
}

}  // namespace
}  // namespace mapweld
