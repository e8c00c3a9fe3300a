#include "schema/edge_store.h"

#include <algorithm>
#include <set>
#include <stdexcept>
#include <tuple>

#include <gtest/gtest.h>

#include "schema/merge_store.h"
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
    e.doubt = random_.chance(0.8) ? Reason::kNone : Reason::kAmbiguous;
    e.verifications = random_.below(1'000);
    e.elapsed_s = random_.unit();
    return e;
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
  const NewEdge inserted = edge(3, 20);
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
  EXPECT_EQ(evidence.edge.confirmed, inserted.doubt == Reason::kNone);
  EXPECT_EQ(evidence.edge.doubt, std::string(to_string(inserted.doubt)));
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

TEST_F(EdgeStoreTest, ConfirmationsMayChange) {
  const std::uint64_t revision = find_map(store_.read(), merged_)->revision;
  std::vector<EdgeDoubt> doubts;
  for (const EdgeRow& e : list_merge_edges(store_.read(), job_, 100)) doubts.push_back({e.u, e.v});
  ASSERT_GT(doubts.size(), 3u);
  for (const Reason reason : {Reason::kUnsupported, Reason::kAmbiguous, Reason::kNone}) {
    for (EdgeDoubt& d : doubts) d.doubt = reason;
    WriteTransaction db = store_.write();
    set_doubts(db, merged_, doubts);
    for (const EdgeRow& e : list_merge_edges(db, job_, 100)) {
      EXPECT_EQ(e.confirmed, reason == Reason::kNone);
      EXPECT_EQ(e.doubt, std::string(to_string(reason)));
    }
    for (const NewEdge& e : load_merge_edges(db, job_)) EXPECT_EQ(e.doubt, reason);
    db.commit();
  }
  EXPECT_EQ(find_map(store_.read(), merged_)->revision, revision + 3);
}

}  // namespace
}  // namespace mapweld
