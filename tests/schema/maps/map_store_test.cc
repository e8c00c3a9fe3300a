#include "schema/maps/map_store.h"

#include <algorithm>
#include <map>
#include <stdexcept>

#include <gtest/gtest.h>

#include "schema/maps/camera_store.h"
#include "schema/maps/map_layout.h"
#include "schema/merges/merge_store.h"
#include "tests/support/temp_store.h"

namespace mapweld {
namespace {

using test::Random;
using test::TempStore;

class MapStoreTest : public testing::Test {
 protected:
  void grow(MapId map, int vertices) {
    for (int i = 0; i < vertices; ++i) {
      test::add_vertex(store_, map, vocabulary_, std::to_string(next_name_++), AppearanceVector{320, 240, {}});
    }
  }
  MapId merge(std::string_view name, std::vector<MapId> members) {
    WriteTransaction db = store_.write();
    const MapId merged = insert_merged_map(db, test::new_map(name, vocabulary_), members);
    insert_merge(db, {merged, "quickconnect", 7, "{}", "{}", test::at(3)});
    db.commit();
    return merged;
  }
  std::uint32_t extend(MapId merged) {
    WriteTransaction db = store_.write();
    const std::uint32_t gained = extend_merged_map(db, merged);
    db.commit();
    return gained;
  }
  DeleteOutcome remove(MapId map) {
    WriteTransaction db = store_.write();
    const DeleteOutcome outcome = delete_map(db, map);
    db.commit();
    return outcome;
  }

  TempStore store_;
  VocabularyId vocabulary_ = test::add_vocabulary(store_);
  int next_name_ = 0;
};

TEST_F(MapStoreTest, ItsCameraIsWhatWasSetLastAndGoesWithIt) {
  const MapId map = test::add_map(store_, "lab-a", vocabulary_);
  WriteTransaction db = store_.write();
  const auto revision = [&] { return find_map(db, map)->revision; };
  EXPECT_EQ(find_map_camera(db, map), std::nullopt);
  set_map_camera(db, map, std::nullopt);
  EXPECT_EQ(revision(), 0U);
  set_map_camera(db, map, "{}");
  set_map_camera(db, map, R"({"model":"pinhole"})");
  EXPECT_EQ(revision(), 2U);
  set_map_camera(db, map, R"({"model":"pinhole"})");
  EXPECT_EQ(revision(), 2U);
  EXPECT_EQ(find_map_camera(db, map), R"({"model":"pinhole"})");
  EXPECT_EQ(delete_map(db, map), DeleteOutcome::kDeleted);
  EXPECT_EQ(find_map_camera(db, map), std::nullopt);
}

TEST_F(MapStoreTest, AMapComesBackAsItWasStored) {
  NewMap map = test::new_map("lab-a", vocabulary_);
  WriteTransaction db = store_.write();
  const MapId id = insert_map(db, map);
  EXPECT_TRUE(change_map(db, id, "lab-a", R"({"robot":"p3at-2"})", find_map(db, id)->parameters));
  EXPECT_FALSE(change_map(db, MapId{99}, "lab-b", "{}", "{}"));
  db.commit();
  store_.reopen();
  const ReadTransaction reader = store_.read();
  for (const auto& row : {find_map(reader, "lab-a"), find_map(reader, id), find_map_by_uuid(reader, map.uuid)}) {
    ASSERT_TRUE(row);
    EXPECT_EQ(row->id, id);
    EXPECT_EQ(row->name, "lab-a");
    EXPECT_EQ(row->uuid, map.uuid);
    EXPECT_EQ(row->kind, MapKind::kMap);
    EXPECT_EQ(row->vocabulary, vocabulary_);
    EXPECT_EQ(row->parameters, map.parameters);
    EXPECT_EQ(row->labels, R"({"robot":"p3at-2"})");
    EXPECT_EQ(row->created_at, map.created_at);
    EXPECT_EQ(row->vertices, 0U);
    EXPECT_EQ(row->revision, 1U);  // it was changed once
  }
  EXPECT_FALSE(find_map(reader, "LAB-A"));
  EXPECT_FALSE(find_map(reader, MapId{99}));
}

TEST_F(MapStoreTest, NamesAndUuidsAreUniqueAndNumbersNeverComeBack) {
  const MapId first = test::add_map(store_, "a", vocabulary_);
  EXPECT_THROW(test::add_map(store_, "a", vocabulary_), StoreError);
  EXPECT_EQ(remove(first), DeleteOutcome::kDeleted);
  EXPECT_EQ(remove(first), DeleteOutcome::kNotFound);
  EXPECT_NE(test::add_map(store_, "a", vocabulary_), first);
}

TEST_F(MapStoreTest, BrokenJsonIsRefused) {
  NewMap map = test::new_map("a", vocabulary_);
  map.labels = "{";
  WriteTransaction db = store_.write();
  EXPECT_THROW(insert_map(db, map), StoreError);
}

TEST_F(MapStoreTest, ListsArePagedInOrderOfCreation) {
  std::vector<std::string> names;
  for (int i = 0; i < 7; ++i) {
    names.push_back("map-" + std::to_string(6 - i));
    test::add_map(store_, names.back(), vocabulary_);
  }
  const ReadTransaction reader = store_.read();
  std::vector<std::string> read;
  std::optional<MapId> after;
  for (;;) {
    const auto page = list_maps(reader, 3, after);
    for (const MapRow& map : page) read.push_back(map.name);
    if (page.size() < 3) break;
    after = page.back().id;
  }
  EXPECT_EQ(read, names);
}

TEST_F(MapStoreTest, AMapThatAMergeNamesCannotBeDeleted) {
  const MapId a = test::add_map(store_, "a", vocabulary_);
  const MapId b = test::add_map(store_, "b", vocabulary_);
  const MapId c = test::add_map(store_, "c", vocabulary_);
  grow(a, 2);
  const MapId ab = merge("ab", {a, b});
  const MapId abc = merge("abc", {ab, c});
  EXPECT_EQ(remove(a), DeleteOutcome::kInUse);
  EXPECT_EQ(remove(b), DeleteOutcome::kInUse);  // a member without vertices is a member too
  EXPECT_EQ(remove(ab), DeleteOutcome::kInUse);
  {
    const ReadTransaction reader = store_.read();
    ASSERT_EQ(list_merged_over(reader, a).size(), 1U);
    EXPECT_EQ(list_merged_over(reader, a)[0].name, "ab");
    EXPECT_TRUE(list_merged_over(reader, abc).empty());
  }
  EXPECT_EQ(remove(abc), DeleteOutcome::kDeleted);
  EXPECT_EQ(remove(ab), DeleteOutcome::kDeleted);
  const ReadTransaction reader = store_.read();
  EXPECT_TRUE(list_merges(reader, 10).empty());
  EXPECT_EQ(find_map(reader, a)->vertices, 2U);
}

TEST_F(MapStoreTest, MembersAreNumberedInTheOrderGivenAndGrowAtTheEnd) {
  const MapId a = test::add_map(store_, "a", vocabulary_);
  const MapId b = test::add_map(store_, "b", vocabulary_);
  grow(a, 3);
  grow(b, 2);
  const MapId merged = merge("ba", {b, a});
  grow(a, 2);
  {
    const ReadTransaction reader = store_.read();
    const MapLayout layout = load_layout(reader, merged);
    EXPECT_EQ(layout.vertices(), 5U);
    EXPECT_EQ(layout.leaf(VertexId{0}), (LeafVertex{b, VertexId{0}}));
    EXPECT_EQ(layout.leaf(VertexId{2}), (LeafVertex{a, VertexId{0}}));
    EXPECT_THROW(layout.leaf(VertexId{5}), std::out_of_range);
    const auto members = list_members(reader, merged);
    ASSERT_EQ(members.size(), 2U);
    EXPECT_EQ(members[0].name, "b");
    EXPECT_EQ(members[1].watermark, 3U);
    EXPECT_EQ(members[1].vertices, 5U);
  }
  grow(b, 1);
  EXPECT_EQ(extend(merged), 3U);
  EXPECT_EQ(extend(merged), 0U);
  const ReadTransaction reader = store_.read();
  const MapLayout layout = load_layout(reader, merged);
  EXPECT_EQ(layout.vertices(), 8U);
  EXPECT_EQ(layout.leaf(VertexId{5}), (LeafVertex{b, VertexId{2}}));
  EXPECT_EQ(layout.leaf(VertexId{6}), (LeafVertex{a, VertexId{3}}));
  EXPECT_EQ(find_map(reader, merged)->vertices, 8U);
}

TEST_F(MapStoreTest, AMergedMapNeedsTwoMembersOfItsVocabulary) {
  const MapId a = test::add_map(store_, "a", vocabulary_);
  const MapId other = test::add_map(store_, "other", test::add_vocabulary(store_, "other"));
  WriteTransaction db = store_.write();
  EXPECT_THROW(insert_merged_map(db, test::new_map("m1", vocabulary_), std::vector{a}), StoreError);
  EXPECT_THROW(insert_merged_map(db, test::new_map("m2", vocabulary_), std::vector{a, other}), StoreError);
  EXPECT_THROW(insert_merged_map(db, test::new_map("m3", vocabulary_), std::vector{a, MapId{99}}), StoreError);
}

// The oracle numbers vertices one by one: a merged map is a list of (leaf, vertex), which only ever grows at its end.
TEST_F(MapStoreTest, LayoutsOfRandomTreesEqualNumberingOneByOne) {
  Random random(11);
  using List = std::vector<LeafVertex>;
  std::vector<MapId> maps;
  std::map<MapId, List> lists;
  std::map<MapId, std::vector<std::pair<MapId, std::size_t>>> members;  // merged -> member, watermark
  for (int i = 0; i < 4; ++i) {
    maps.push_back(test::add_map(store_, "leaf-" + std::to_string(i), vocabulary_));
    lists[maps.back()] = {};
  }
  for (int round = 0; round < 60; ++round) {
    const MapId some = maps[random.below(maps.size())];
    if (!members.contains(some)) {
      const int count = static_cast<int>(random.below(4));
      grow(some, count);
      for (int i = 0; i < count; ++i) {
        lists[some].push_back({some, VertexId{static_cast<std::uint32_t>(lists[some].size())}});
      }
    } else {
      extend(some);
      for (auto& [member, watermark] : members[some]) {
        const List& from = lists[member];
        lists[some].insert(lists[some].end(), from.begin() + static_cast<std::ptrdiff_t>(watermark), from.end());
        watermark = from.size();
      }
    }
    if (round % 10 == 9) {
      const MapId x = maps[random.below(maps.size())];
      const MapId y = maps[random.below(maps.size())];
      if (x == y) continue;
      const MapId merged = merge("merged-" + std::to_string(round), {x, y});
      maps.push_back(merged);
      for (const MapId member : {x, y}) {
        const List from = lists[member];
        lists[merged].insert(lists[merged].end(), from.begin(), from.end());
        members[merged].emplace_back(member, from.size());
      }
    }
  }
  ASSERT_GT(maps.size(), 6U);
  const ReadTransaction reader = store_.read();
  for (const MapId map : maps) {
    const MapLayout layout = load_layout(reader, map);
    ASSERT_EQ(layout.vertices(), lists[map].size());
    for (std::uint32_t v = 0; v < layout.vertices(); ++v) {
      EXPECT_EQ(layout.leaf(VertexId{v}), lists[map][v]);
      // Exactly one occurrence of a leaf in the tree has it, and numbers it back.
      int owners = 0;
      for (const LayoutNode& node : layout.nodes()) {
        const auto own = node.node_vertex(VertexId{v});
        if (!own) continue;
        EXPECT_LT(to_index(*own), node.watermark);
        EXPECT_EQ(node.number(*own), VertexId{v});
        if (node.kind == MapKind::kMap) {
          ++owners;
          EXPECT_EQ((LeafVertex{node.map, *own}), lists[map][v]);
        }
      }
      EXPECT_EQ(owners, 1);
    }
    for (const LayoutNode& node : layout.nodes()) {
      EXPECT_FALSE(node.number(VertexId{node.watermark}));
      EXPECT_FALSE(node.node_vertex(VertexId{layout.vertices()}));
    }
  }
  EXPECT_THROW(load_layout(reader, MapId{999}), std::out_of_range);
}

}  // namespace
}  // namespace mapweld
