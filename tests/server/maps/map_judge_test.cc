#include "server/maps/map_judge.h"

#include <algorithm>
#include <chrono>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "core/guard/guarded_map.h"
#include "schema/maps/edge_store.h"
#include "server/judge_worker.h"
#include "tests/support/temp_store.h"

namespace mapweld::test {
namespace {

using server::judge_map;
using server::JudgeWorker;
using server::LoadedMap;
using server::MapCache;

constexpr std::uint32_t kWords = 2000;
constexpr int kFeatures = 100;

// Random images; each matches the one before in many features, and a far one in few.
class MapJudgeTest : public ::testing::Test {
 protected:
  MapJudgeTest() : vocabulary_(add_vocabulary(store_, "words", kWords)), map_(add_map(store_, "lab", vocabulary_)) {}

  void grow_to(std::uint32_t vertices) {
    for (std::uint32_t i = row().vertices; i < vertices; ++i) {
      const AppearanceVector vector = random_appearances(random_, kFeatures, kWords);
      images_.push_back(std::make_shared<const AppearanceVector>(vector));
      WriteTransaction db = store_.write();
      std::vector<NewEdge> edges;
      const auto join = [&](std::uint32_t to, int matches) {
        NewEdge edge;
        edge.u = VertexId{to};
        edge.votes = 20;
        edge.verification = random_verification(random_, matches, kFeatures, kFeatures);
        edges.push_back(edge);
      };
      if (i > 0) join(i - 1, 60);
      if (i > 20) join(i - 20, 9);
      insert_vertex(db, map_, vocabulary_, new_image("image-" + std::to_string(i), vector), vector, edges,
                    test_verifier(db));
      db.commit();
    }
  }
  MapRow row() { return find_map(store_.read(), map_).value(); }
  std::size_t unconfirmed() {
    const auto judged = load_judgements(store_.read(), map_);
    return static_cast<std::size_t>(
        std::ranges::count_if(judged, [](const JudgedEdge& e) { return e.judgement.doubt != Reason::kNone; }));
  }

  TempStore store_;
  Random random_{7};
  VocabularyId vocabulary_;
  MapId map_;
  std::vector<std::shared_ptr<const AppearanceVector>> images_;
};

TEST_F(MapJudgeTest, WritesWhatTheMapsOwnImagesSay) {
  grow_to(40);
  MapCache cache(store_, 64 << 20);
  const auto loaded = cache.open(row(), 500);
  EXPECT_TRUE(has_unjudged_edges(store_.read(), map_));
  const auto judged = judge_map(store_, cache, row());
  EXPECT_EQ(judged.edges, row().edges);
  EXPECT_EQ(judged.changed, row().edges);
  EXPECT_FALSE(has_unjudged_edges(store_.read(), map_));

  const auto edges = load_verified_edges(store_.read(), load_layout(store_.read(), map_));
  const GuardedMap expected(40, [&](std::uint32_t v) { return images_[v]; }, edges, {});
  const auto written = load_judgements(store_.read(), map_);
  ASSERT_EQ(written.size(), edges.size());
  for (std::size_t e = 0; e < edges.size(); ++e) {
    const GuardVerdict& verdict = expected.verdicts()[e];
    EXPECT_EQ(written[e].judgement,
              (EdgeJudgement{verdict.confidence, verdict.reason, evidence_items(verdict.evidence)}));
    std::vector<VertexId> linked;
    loaded->neighbours(edges[e].u, linked);
    EXPECT_EQ(std::ranges::find(linked, edges[e].v) != linked.end(), verdict.confirmed());
  }
  EXPECT_GT(unconfirmed(), 0u);
  EXPECT_LT(unconfirmed(), edges.size());
  EXPECT_EQ(row().edges, edges.size()) << "a withheld edge stays a verified one";
}

TEST_F(MapJudgeTest, WritesNothingThatStandsThereAlready) {
  grow_to(30);
  MapCache cache(store_, 64 << 20);
  judge_map(store_, cache, row());
  const auto revision = row().revision;
  EXPECT_EQ(judge_map(store_, cache, row()).changed, 0u);
  EXPECT_EQ(row().revision, revision);
}

TEST_F(MapJudgeTest, AMapThatIsGoneIsLeftAlone) {
  grow_to(5);
  MapCache cache(store_, 64 << 20);
  const MapRow gone = row();
  {
    WriteTransaction db = store_.write();
    delete_map(db, map_);
    db.commit();
  }
  EXPECT_EQ(judge_map(store_, cache, gone).changed, 0u);
}

TEST_F(MapJudgeTest, TheWorkerJudgesWhatGrows) {
  MapCache cache(store_, 64 << 20);
  grow_to(30);
  JudgeWorker worker(store_, cache, 64 << 20, std::chrono::milliseconds{5});
  const auto wait = [&] {
    for (int i = 0; i < 4000 && has_unjudged_edges(store_.read(), map_); ++i) {
      std::this_thread::sleep_for(std::chrono::milliseconds{5});
    }
    return !has_unjudged_edges(store_.read(), map_);
  };
  EXPECT_TRUE(wait());
  grow_to(45);
  EXPECT_TRUE(wait());
  worker.stop();
  grow_to(46);
  EXPECT_TRUE(has_unjudged_edges(store_.read(), map_));
}

}  // namespace
}  // namespace mapweld::test
