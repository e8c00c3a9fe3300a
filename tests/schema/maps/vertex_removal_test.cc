// Deleting, restoring: against maps that never had the images, and against filters over all that there was.
#include "schema/maps/vertex_removal.h"

#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <openssl/sha.h>

#include "core/retrieval/inverted_index.h"
#include "schema/maps/absent_vertices.h"
#include "schema/maps/edge_store.h"
#include "schema/merges/merge_store.h"
#include "schema/segments/segment_store.h"
#include "schema/store_check.h"
#include "tests/support/temp_store.h"

namespace mapweld {
namespace {

constexpr std::uint32_t kVertices = 60;
constexpr std::uint32_t kWords = 200;

VertexId vertex(std::uint32_t number) { return VertexId{number}; }

// Two plain maps of random images with random edges, and a merged map over them with inter edges, some of them
// withheld.
class VertexRemoval : public ::testing::Test {
 protected:
  VertexRemoval() {
    vocabulary_ = test::add_vocabulary(store_, "words", kWords);
    for (const char* name : {"a", "b"}) maps_.push_back(fill(name));
    merge();
  }

  MapId fill(const char* name) {
    const MapId map = test::add_map(store_, name, vocabulary_);
    WriteTransaction db = store_.write();
    const VerifierId verifier = test::test_verifier(db);
    for (std::uint32_t v = 0; v < kVertices; ++v) {
      const AppearanceVector image = test::random_appearances(random_, 30, kWords, true);
      images_[map].push_back(image);
      std::vector<NewEdge> edges;
      for (std::uint32_t u = v > 5 ? v - 5 : 0; u < v; ++u) {
        if (random_.chance(0.5))
          edges.push_back({.u = vertex(u), .verification = test::random_verification(random_, 12, 30, 30)});
      }
      NewImage row = test::new_image("image-" + std::to_string(v), image);
      const auto bytes = test::random_bytes(random_, 100);
      row.bytes = bytes;
      SHA256(bytes.data(), bytes.size(), row.sha256.data());
      insert_vertex(db, map, vocabulary_, row, image, edges, verifier);
    }
    db.commit();
    return map;
  }

  void merge() {
    WriteTransaction db = store_.write();
    merged_ = insert_merged_map(db, test::new_map("ab", vocabulary_), maps_);
    job_ = insert_merge(db, {.map = merged_,
                             .method = "quickconnect",
                             .parameters = R"({"min_votes":0,"min_confidence":0.9})",
                             .created_at = test::at(0)});
    std::vector<NewEdge> edges;
    for (std::uint32_t u = 0; u < kVertices; u += 2) {
      NewEdge edge{.u = vertex(u),
                   .v = vertex(kVertices + (u * 7) % kVertices),
                   .verification = test::random_verification(random_, 12, 30, 30)};
      edge.judgement.confidence = random_.chance(0.7) ? 0.95 : 0.4;
      if (*edge.judgement.confidence < 0.9) edge.judgement.doubt = Reason::kUnsupported;
      edges.push_back(std::move(edge));
    }
    insert_edges(db, merged_, edges, test::test_verifier(db), job_);
    db.commit();
  }

  void remove(MapId map, std::uint32_t first, std::uint64_t count = 1) {
    WriteTransaction db = store_.write();
    delete_vertices(db, map, vertex(first), count, test::at(9));
    db.commit();
  }
  bool restore(MapId map, std::uint32_t number) {
    WriteTransaction db = store_.write();
    const bool restored = restore_vertex(db, map, vertex(number));
    db.commit();
    return restored;
  }

  using Ends = std::vector<std::pair<VertexId, VertexId>>;
  Ends edges_of(MapId map, const EdgeFilter& filter = {}) {
    const ReadTransaction db = store_.read();
    Ends ends;
    for (const EdgeRow& edge : list_edges(db, load_layout(db, map), filter, 10'000).edges)
      ends.emplace_back(edge.u, edge.v);
    return ends;
  }
  // Everything that readers say of a map, but for its revision.
  std::string told(MapId map) {
    const ReadTransaction db = store_.read();
    const MapLayout layout = load_layout(db, map);
    std::string text;
    for (const VertexRow& row : list_vertices(db, layout, 10'000)) {
      text += std::to_string(to_index(row.vertex)) + row.image.name + " ";
    }
    for (const EdgeRow& edge : list_edges(db, layout, {}, 10'000).edges) {
      text += std::to_string(to_index(edge.id)) + ":" + std::to_string(to_index(edge.u)) + "-" +
              std::to_string(to_index(edge.v)) + (edge.confirmed ? " " : "? ");
    }
    for (const bool confirmed : {false, true})
      text += std::to_string(count_edges(db, layout, {.confirmed = confirmed})) + " ";
    for (const std::int64_t degree : count_confirmed_edges_at(db, layout, VertexId{0}, layout.vertices())) {
      text += std::to_string(degree) + ",";
    }
    return text;
  }
  void expect_in_order() {
    for (const Finding& finding : check_store(store_.read()).findings) {
      if (finding.where.starts_with("checkpoints")) continue;  // the merge has none
      ADD_FAILURE() << finding.where << ": " << finding.what;
    }
  }

  test::Random random_{7};
  test::TempStore store_;
  VocabularyId vocabulary_{};
  std::vector<MapId> maps_;
  MapId merged_{};
  JobId job_{};
  std::map<MapId, std::vector<AppearanceVector>> images_;
};

TEST_F(VertexRemoval, EdgesAndVerticesOfDeletedImagesShowNowhere) {
  const std::vector<std::pair<MapId, std::uint32_t>> gone = {
      {maps_[0], 4}, {maps_[0], 5}, {maps_[1], 0}, {maps_[1], 59}};
  std::map<MapId, std::set<VertexId>> absent;
  for (const auto& [map, number] : gone) {
    absent[map].insert(vertex(number));
    absent[merged_].insert(vertex(number + (map == maps_[1] ? kVertices : 0)));
  }
  std::map<MapId, Ends> before;
  std::map<MapId, std::uint64_t> revisions;
  for (const MapId map : {maps_[0], maps_[1], merged_}) {
    before[map] = edges_of(map);
    revisions[map] = find_map(store_.read(), map)->revision;
  }
  remove(maps_[0], 4, 2);
  remove(maps_[1], 0);
  remove(maps_[1], 59, 1'000'000'000'000);  // beyond the map
  remove(maps_[1], 59);                     // not there any more
  store_.reopen();

  const ReadTransaction db = store_.read();
  for (const MapId map : {maps_[0], maps_[1], merged_}) {
    const auto is_gone = [&](VertexId v) { return absent[map].contains(v); };
    Ends expected = before[map];
    std::erase_if(expected, [&](const auto& ends) { return is_gone(ends.first) || is_gone(ends.second); });
    EXPECT_LT(expected.size(), before[map].size());
    EXPECT_EQ(edges_of(map), expected);
    const MapLayout layout = load_layout(db, map);
    EXPECT_EQ(count_edges(db, layout), expected.size());
    EXPECT_EQ(load_edges(db, layout).size(), expected.size());
    EXPECT_EQ(load_verified_edges(db, layout).size(), expected.size());
    std::map<VertexId, std::int64_t> degrees;
    for (const auto& [u, v] : edges_of(map, {.confirmed = true})) ++degrees[u], ++degrees[v];
    for (std::uint32_t v = 0; v < layout.vertices(); ++v) {
      EXPECT_EQ(count_confirmed_edges_at(db, layout, vertex(v), 1).front(), degrees[vertex(v)]);
      const LeafVertex leaf = layout.leaf(vertex(v));
      EXPECT_EQ(find_vertex(db, leaf.map, leaf.vertex).has_value(), !is_gone(vertex(v)));
      EXPECT_TRUE(!is_gone(vertex(v)) || list_edges_at(db, layout, vertex(v)).empty());
    }
    EXPECT_EQ(list_vertices(db, layout, 10'000).size(), layout.vertices() - absent[map].size());
    EXPECT_EQ(absent_vertices(db, layout).vertices(), std::vector<VertexId>(absent[map].begin(), absent[map].end()));
    EXPECT_GT(find_map(db, map)->revision, revisions[map]);
    EXPECT_EQ(find_map(db, map)->vertices, layout.vertices()) << "numbers stay given";
  }
  EXPECT_TRUE(find_vertices(db, load_layout(db, maps_[0]), "image-4").empty());
  EXPECT_EQ(find_vertices(db, load_layout(db, merged_), "image-4").size(), 1u) << "b's own";
  EXPECT_TRUE(find_image(db, maps_[0], "image-4")->deleted_at);
  for (const EdgeRow& edge : list_merge_edges(db, job_, 10'000)) {
    EXPECT_FALSE(absent[merged_].contains(edge.u) || absent[merged_].contains(edge.v));
  }
  expect_in_order();
}

TEST_F(VertexRemoval, RestoringBringsEverythingBack) {
  std::map<MapId, std::string> before;
  for (const MapId map : {maps_[0], maps_[1], merged_}) before[map] = told(map);
  remove(maps_[0], 10, 3);
  remove(maps_[1], 10, 40);
  EXPECT_NE(told(merged_), before[merged_]);
  store_.reopen();
  std::vector<std::pair<MapId, std::uint32_t>> gone;
  for (std::uint32_t v = 10; v < 13; ++v) gone.emplace_back(maps_[0], v);
  for (std::uint32_t v = 10; v < 50; ++v) gone.emplace_back(maps_[1], v);
  while (!gone.empty()) {
    const std::size_t i = random_.below(gone.size());
    EXPECT_TRUE(restore(gone[i].first, gone[i].second));
    EXPECT_FALSE(restore(gone[i].first, gone[i].second));
    gone.erase(gone.begin() + static_cast<std::ptrdiff_t>(i));
    if (gone.size() % 10 == 0) expect_in_order();
  }
  for (const MapId map : {maps_[0], maps_[1], merged_}) EXPECT_EQ(told(map), before[map]);
  EXPECT_FALSE(restore(maps_[0], 3)) << "it was not deleted";
  EXPECT_EQ(standing_of(store_.read(), maps_[0], vertex(3)), VertexStanding::kThere);
  EXPECT_EQ(standing_of(store_.read(), maps_[0], vertex(kVertices)), VertexStanding::kNeverGiven);
}

// The index is that of maps whose deleted images have no features, whether postings come from segments, written before
// or after, or from appearances.
TEST_F(VertexRemoval, NoVotesAreGivenToDeletedImages) {
  const auto expect_index = [&](MapId map, const std::set<std::uint32_t>& gone) {
    InvertedIndex expected;
    const ReadTransaction db = store_.read();
    const MapLayout layout = load_layout(db, map);
    for (std::uint32_t v = 0; v < layout.vertices(); ++v) {
      const LeafVertex leaf = layout.leaf(vertex(v));
      expected.add(gone.contains(v) ? AppearanceVector{} : images_[leaf.map][to_index(leaf.vertex)]);
    }
    const InvertedIndex index = load_index(db, map, vocabulary_);
    const SegmentPostingSource stored(db, layout, vocabulary_);
    ASSERT_EQ(index.vertices(), expected.vertices());
    for (std::uint32_t word = 0; word < kWords; ++word) {
      EXPECT_EQ(index.postings(WordId{word}), expected.postings(WordId{word}));
      EXPECT_EQ(stored.postings(WordId{word}), expected.postings(WordId{word}));
    }
  };
  const SegmentOptions options{.vertices = 8, .fan_in = 2, .max_vertices = 32};
  remove(maps_[0], 3);
  remove(maps_[0], 58, 2);
  expect_index(maps_[0], {3, 58, 59});
  write_due_segments(store_, options);
  expect_index(maps_[0], {3, 58, 59});
  remove(maps_[0], 16, 8);  // a segment
  remove(maps_[1], 0);
  expect_index(merged_, {3, 16, 17, 18, 19, 20, 21, 22, 23, 58, 59, kVertices});
  ASSERT_TRUE(restore(maps_[0], 3));
  expect_index(maps_[0], {16, 17, 18, 19, 20, 21, 22, 23, 58, 59});
  expect_in_order();

  const std::vector<AppearanceVector> some = load_appearances(store_.read(), maps_[0], vocabulary_, vertex(15), 3);
  EXPECT_EQ(some, (std::vector<AppearanceVector>{images_[maps_[0]][15], {}, {}}));
}

TEST_F(VertexRemoval, DeletedImagesTakeNoEdges) {
  remove(maps_[0], 3);
  WriteTransaction db = store_.write();
  const AppearanceVector image = test::random_appearances(random_, 30, kWords, true);
  const std::vector<NewEdge> edges = {{.u = vertex(3), .verification = test::random_verification(random_, 12, 30, 30)}};
  EXPECT_THROW(
      insert_vertex(db, maps_[0], vocabulary_, test::new_image("new", image), image, edges, test::test_verifier(db)),
      StoreError);
}

TEST_F(VertexRemoval, ADamagedEdgeIsAsDamagedWhereItIsMoved) {
  {
    sqlite::Connection stranger(store_.store().file(), sqlite::OpenMode::kReadWrite);
    stranger.execute("UPDATE edges SET votes = votes + 1 WHERE id = (SELECT max(id) FROM edges WHERE job IS NULL)");
  }
  const auto damaged_in = [&] {
    std::vector<std::string> tables;
    for (const Finding& finding : check_store(store_.read()).findings) {
      if (finding.where == where_of_checkpoint(job_)) continue;  // this merge has none
      tables.push_back(finding.where.substr(0, finding.where.find(':')));
    }
    return tables;
  };
  EXPECT_EQ(damaged_in(), std::vector<std::string>{"edges"});
  WriteTransaction db = store_.write();
  const VertexId end = vertex(kVertices - 1);
  delete_vertices(db, maps_[1], end, 1, test::at(1));
  db.commit();
  EXPECT_EQ(damaged_in(), std::vector<std::string>{"deleted_edges"});
  WriteTransaction again = store_.write();
  restore_vertex(again, maps_[1], end);
  again.commit();
  EXPECT_EQ(damaged_in(), std::vector<std::string>{"edges"});
}

TEST_F(VertexRemoval, AnImageMayLoseItsBytesOnly) {
  const std::uint64_t revision = find_map(store_.read(), maps_[0])->revision;
  const ImageId image = find_vertex(store_.read(), maps_[0], vertex(7))->id;
  ASSERT_TRUE(load_image_bytes(store_.read(), image));
  for (int i = 0; i < 2; ++i) {
    WriteTransaction db = store_.write();
    delete_image_bytes(db, maps_[0], vertex(7));
    db.commit();
  }
  EXPECT_FALSE(load_image_bytes(store_.read(), image));
  EXPECT_TRUE(find_vertex(store_.read(), maps_[0], vertex(7)));
  EXPECT_EQ(find_map(store_.read(), maps_[0])->revision, revision + 1);
  expect_in_order();
}

}  // namespace
}  // namespace mapweld
