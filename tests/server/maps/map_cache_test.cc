#include "server/maps/map_cache.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <memory>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "core/retrieval/inverted_index.h"
#include "schema/segments/segment_store.h"
#include "server/maps/stored_map.h"
#include "tests/support/temp_store.h"

namespace mapweld::test {
namespace {

using server::LoadedMap;
using server::MapCache;
using server::StoredMap;

constexpr std::uint32_t kWords = 200;
constexpr int kFeatures = 100;

class MapCacheTest : public ::testing::Test {
 protected:
  MapCacheTest() : vocabulary_(add_vocabulary(store_, "words", kWords)) {}

  // A map of so many random images, each with an edge to the one before.
  MapRow fill(const std::string& name, int vertices) {
    const MapId map = add_map(store_, name, vocabulary_);
    for (int i = 0; i < vertices; ++i) add(map);
    return row(map);
  }

  void add(MapId map) {
    const AppearanceVector vector = random_appearances(random_, kFeatures, kWords, random_.chance(0.8));
    WriteTransaction db = store_.write();
    const std::uint32_t number = find_map(db, map)->vertices;
    std::vector<NewEdge> edges;
    if (number > 0) {
      NewEdge edge;
      edge.u = VertexId{number - 1};
      edge.votes = 20;
      edge.verification = random_verification(random_, 15, kFeatures, kFeatures);
      edges.push_back(edge);
    }
    insert_vertex(db, map, vocabulary_, new_image("image-" + std::to_string(number), vector), vector, edges,
                  test_verifier(db));
    db.commit();
  }

  MapRow row(MapId map) { return find_map(store_.read(), map).value(); }

  std::size_t size_of(const MapRow& map) { return LoadedMap(store_, store_.read(), map).memory_bytes(); }

  TempStore store_;
  Random random_{7};
  VocabularyId vocabulary_;
};

PostingList postings(const server::LeafSource& map, WordId word, std::uint32_t first, std::uint32_t end) {
  PostingList out;
  map.visit(word, VertexId{first}, VertexId{end}, [&out](const PostingSpan& part) { out.append(part); });
  return out;
}

// Who shares a confirmed edge with a vertex, and who any, ascending.
using Links = std::pair<std::vector<VertexId>, std::vector<VertexId>>;
Links links_of(const server::LeafSource& map, std::uint32_t vertex) {
  Links links;
  map.neighbours(VertexId{vertex}, links.first);
  map.linked(VertexId{vertex}, links.second);
  std::ranges::sort(links.first);
  std::ranges::sort(links.second);
  return links;
}

TEST_F(MapCacheTest, InMemoryAndInTheStoreAMapReadsTheSame) {
  const MapRow map = fill("lab", 40);
  write_due_segments(store_,
                     {.vertices = 16, .fan_in = 8, .max_vertices = 1 << 16});  // part segments, part appearances
  const LoadedMap loaded(store_, store_.read(), map);
  const StoredMap stored(store_, map.id, vocabulary_);
  InvertedIndex oracle;
  for (const AppearanceVector& vector : load_appearances(store_.read(), map.id, vocabulary_, VertexId{0}, 40)) {
    oracle.add(vector);
  }
  for (std::uint32_t word = 0; word < kWords; ++word) {
    for (const auto& [first, end] : {std::pair{0u, 40u}, std::pair{0u, 17u}, std::pair{9u, 33u}, std::pair{5u, 5u}}) {
      PostingList expected;
      const PostingSpan all = oracle.find(WordId{word});
      for (std::size_t k = 0; k < all.size(); ++k) {
        const std::uint32_t vertex = to_index(all.vertices[k]);
        if (vertex >= first && vertex < end) expected.add(all.vertices[k], all.signatures[k]);
      }
      EXPECT_EQ(postings(loaded, WordId{word}, first, end), expected);
      EXPECT_EQ(postings(stored, WordId{word}, first, end), expected);
    }
  }
  for (std::uint32_t vertex = 0; vertex < 40; ++vertex) {
    EXPECT_EQ(*loaded.appearances(VertexId{vertex}), *stored.appearances(VertexId{vertex}));
    EXPECT_EQ(links_of(loaded, vertex), links_of(stored, vertex));
    EXPECT_EQ(links_of(loaded, vertex).first.size(), vertex == 0 || vertex == 39 ? 1u : 2u);
  }
}

TEST_F(MapCacheTest, AMapInUseIsOneObject) {
  const MapRow map = fill("lab", 3);
  MapCache cache(store_, 64 << 20);
  const auto first = cache.open(map, kFeatures);
  EXPECT_EQ(cache.open(map, kFeatures), first);
  EXPECT_EQ(cache.statistics().maps, 1u);
  EXPECT_GT(cache.statistics().bytes, 0u);
}

TEST_F(MapCacheTest, TheLeastRecentlyUsedMakesRoom) {
  const MapRow a = fill("a", 10);
  const MapRow b = fill("b", 10);
  const MapRow c = fill("c", 10);
  MapCache cache(store_, 5 * size_of(a) / 2);  // two of the three
  const LoadedMap* kept = cache.open(a, kFeatures).get();
  cache.open(b, kFeatures);
  cache.open(a, kFeatures);
  cache.open(c, kFeatures);  // b goes
  EXPECT_EQ(cache.statistics().maps, 2u);
  EXPECT_EQ(cache.open(a, kFeatures).get(), kept);
}

TEST_F(MapCacheTest, MapsInUseStayWhateverTheyTake) {
  const MapRow a = fill("a", 10);
  const MapRow b = fill("b", 10);
  MapCache cache(store_, size_of(a) + 1);
  const auto in_use = cache.open(a, kFeatures);
  const auto vector = in_use->appearances(VertexId{3});
  const std::size_t with_vector = in_use->memory_bytes();
  const auto also = cache.open(b, kFeatures);
  EXPECT_EQ(cache.statistics().maps, 2u);
  EXPECT_EQ(cache.open(a, kFeatures), in_use);
  EXPECT_LT(in_use->memory_bytes(), with_vector);  // but they let go of what can be read again
  EXPECT_EQ(*in_use->appearances(VertexId{3}), *vector);
}

TEST_F(MapCacheTest, AMapBeyondTheCapacityIsNotLoaded) {
  const MapRow map = fill("lab", 10);
  MapCache cache(store_, 1000);
  EXPECT_EQ(cache.open(map, kFeatures), nullptr);
  EXPECT_EQ(cache.statistics().maps, 0u);
}

TEST_F(MapCacheTest, ADeletedMapIsNotFound) {
  const MapRow map = fill("lab", 3);
  MapCache cache(store_, 64 << 20);
  {
    WriteTransaction db = store_.write();
    delete_map(db, map.id);
    db.commit();
  }
  EXPECT_THROW(cache.open(map, kFeatures), std::out_of_range);
  EXPECT_EQ(cache.statistics().maps, 0u);
}

TEST_F(MapCacheTest, AReaderWithAnOldSnapshotDoesNotMakeAnOldMap) {
  const MapRow before = fill("lab", 5);
  add(before.id);
  MapCache cache(store_, 64 << 20);
  EXPECT_EQ(cache.open(before, kFeatures)->committed(), 6u);
}

TEST_F(MapCacheTest, RollbackForgetsWhatWasAppended) {
  const MapRow map = fill("lab", 5);
  LoadedMap loaded(store_, store_.read(), map);
  const LoadedMap untouched(store_, store_.read(), map);
  const auto image = std::make_shared<const AppearanceVector>(random_appearances(random_, kFeatures, kWords));
  const std::vector<VertexId> edges = {VertexId{1}, VertexId{4}};
  EXPECT_EQ(loaded.append(image, edges), VertexId{5});
  EXPECT_EQ(loaded.append(image, std::vector{VertexId{5}}), VertexId{6});
  EXPECT_EQ(loaded.committed(), 5u);
  EXPECT_EQ(loaded.appearances(VertexId{6}), image);
  loaded.rollback();
  EXPECT_THROW(loaded.appearances(VertexId{5}), std::out_of_range);
  for (std::uint32_t word = 0; word < kWords; ++word) {
    EXPECT_EQ(postings(loaded, WordId{word}, 0, 100), postings(untouched, WordId{word}, 0, 100));
  }
  for (std::uint32_t vertex = 0; vertex < 5; ++vertex) {
    EXPECT_EQ(links_of(loaded, vertex), links_of(untouched, vertex));
  }
  EXPECT_EQ(loaded.append(image, std::vector{VertexId{2}}), VertexId{5});
  std::vector<VertexId> anew;
  loaded.neighbours(VertexId{5}, anew);
  EXPECT_EQ(anew, std::vector{VertexId{2}});
  loaded.commit();
  EXPECT_EQ(loaded.committed(), 6u);
  loaded.rollback();
  EXPECT_EQ(loaded.appearances(VertexId{5}), image);
}

TEST_F(MapCacheTest, WhatIsRolledBackIsNotCounted) {
  LoadedMap loaded(store_, store_.read(), fill("lab", 5));
  const std::size_t before = loaded.memory_bytes();
  const auto image = std::make_shared<const AppearanceVector>(random_appearances(random_, kFeatures, kWords));
  for (int failed = 0; failed < 1'000; ++failed) {
    loaded.append(image, std::vector{VertexId{1}, VertexId{4}});
    loaded.append(image, std::vector{VertexId{2}, VertexId{5}});
    loaded.append(image, std::vector{VertexId{5}, VertexId{6}});
    EXPECT_GT(loaded.memory_bytes(), before + 3 * image->appearances.size() * sizeof(Appearance));
    loaded.rollback();
    ASSERT_EQ(loaded.memory_bytes(), before);
  }
  loaded.append(image, std::vector{VertexId{1}});
  const std::size_t with_one = loaded.memory_bytes();
  loaded.commit();
  loaded.append(image, std::vector{VertexId{5}});
  loaded.rollback();
  EXPECT_EQ(loaded.memory_bytes(), with_one);
}

TEST_F(MapCacheTest, TheGraphInMemoryFollowsWhatIsThoughtOfItsEdges) {
  const MapRow map = fill("lab", 8);
  MapCache cache(store_, 1 << 20);
  const auto loaded = cache.open(map, kFeatures);
  const auto expect_as_stored = [&] {
    const StoredMap stored(store_, map.id, vocabulary_);
    const LoadedMap fresh(store_, store_.read(), map);
    for (std::uint32_t v = 0; v < 8; ++v) {
      EXPECT_EQ(links_of(*loaded, v), links_of(stored, v));
      EXPECT_EQ(links_of(fresh, v), links_of(stored, v));
    }
  };
  const auto judge = [&](std::vector<JudgedEdge> edges) {
    const auto turn = cache.writer_turn(map.id);
    {
      WriteTransaction db = store_.write();
      set_judgements(db, map.id, edges);
      db.commit();
    }
    cache.follow_judgements(map.id, edges);
  };
  expect_as_stored();
  judge({{VertexId{2}, VertexId{3}, {0.25, Reason::kUnsupported, {}}},
         {VertexId{3}, VertexId{4}, {0.95, Reason::kNone, {}}}});
  EXPECT_EQ(links_of(*loaded, 3), (Links{{VertexId{4}}, {VertexId{2}, VertexId{4}}}));
  expect_as_stored();
  judge({{VertexId{2}, VertexId{3}, {0.95, Reason::kNone, {}}}});
  expect_as_stored();
}

TEST_F(MapCacheTest, WritersOfOneMapTakeTurns) {
  MapCache cache(store_, 64 << 20);
  std::atomic<int> inside{0};
  std::atomic<int> most{0};
  std::vector<std::thread> writers;
  for (int i = 0; i < 4; ++i) {
    writers.emplace_back([&] {
      for (int turn = 0; turn < 50; ++turn) {
        const auto mine = cache.writer_turn(MapId{1});
        most = std::max(most.load(), ++inside);
        --inside;
      }
    });
  }
  for (std::thread& writer : writers) writer.join();
  EXPECT_EQ(most, 1);
  const auto one = cache.writer_turn(MapId{1});
  const auto other = cache.writer_turn(MapId{2});  // does not wait
  EXPECT_TRUE(one.owns_lock() && other.owns_lock());
}

TEST_F(MapCacheTest, ManyThreadsMayOpenAndReadAtOnce) {
  std::vector<MapRow> maps;
  for (int i = 0; i < 4; ++i) maps.push_back(fill("map-" + std::to_string(i), 8));
  MapCache cache(store_, 2 * size_of(maps[0]));
  std::vector<std::thread> readers;
  std::atomic<int> wrong{0};
  for (int thread = 0; thread < 4; ++thread) {
    readers.emplace_back([&, thread] {
      for (int i = 0; i < 60; ++i) {
        const auto map = cache.open(maps[static_cast<std::size_t>(i * (thread + 1)) % 4], kFeatures);
        if (!map || map->committed() != 8) ++wrong;
        std::size_t found = 0;
        for (std::uint32_t word = 0; word < kWords; ++word) found += postings(*map, WordId{word}, 0, 8).size();
        if (found == 0 || map->appearances(VertexId{static_cast<std::uint32_t>(i) % 8})->appearances.empty()) ++wrong;
      }
    });
  }
  for (std::thread& reader : readers) reader.join();
  EXPECT_EQ(wrong, 0);
}

TEST_F(MapCacheTest, ALongMapIsNotWaitedFor) {
  const MapRow small = fill("small", 4), large = fill("large", 5);
  MapCache cache(store_, 64 << 20, 4);
  EXPECT_NE(cache.open_unless_long(small, kFeatures), nullptr);
  EXPECT_EQ(cache.open_unless_long(large, kFeatures), nullptr);
  std::shared_ptr<LoadedMap> loaded;
  const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(60);
  while (!loaded && std::chrono::steady_clock::now() < deadline) {
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
    loaded = cache.open_unless_long(large, kFeatures);
  }
  ASSERT_NE(loaded, nullptr);
  EXPECT_EQ(loaded->committed(), 5u);
  EXPECT_EQ(cache.open(large, kFeatures), loaded);
  EXPECT_EQ(MapCache(store_, 1000, 4).open_unless_long(large, kFeatures), nullptr);
}

TEST_F(MapCacheTest, WhatIsReadBesideMayBeDeletedMeanwhile) {
  const MapRow large = fill("large", 5);
  for (int i = 0; i < 20; ++i) {
    MapCache cache(store_, 64 << 20, 4);
    cache.open_unless_long(large, kFeatures);
    if (i % 2 == 0) cache.forget(large.id);
  }
}

}  // namespace
}  // namespace mapweld::test
