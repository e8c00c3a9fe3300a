// How SQLite goes about the statements that list what is in a map: by an index that gives the rows in their order, and
// no more of them than are asked for. The statements are those that the functions leave prepared on their connection.
#include <algorithm>
#include <functional>
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <sqlite3.h>

#include "schema/merges/merge_store.h"
#include "tests/support/temp_store.h"

namespace mapweld {
namespace {

using Plan = std::vector<std::string>;
using Plans = std::set<Plan>;

class QueryPlan : public testing::Test {
 protected:
  void SetUp() override {
    for (const MapId map : {a_, b_}) {
      for (const char* name : {"0", "1", "2"}) test::add_vertex(store_, map, vocabulary_, name, {320, 240, {}});
    }
    WriteTransaction db = store_.write();
    merged_ = insert_merged_map(db, test::new_map("ab", vocabulary_), std::vector{a_, b_});
    job_ = insert_merge(db, {merged_, "quickconnect", 7, "{}", "{}", test::at(3)});
    db.commit();
    test::add_vertex(store_, a_, vocabulary_, "beyond the watermark", {320, 240, {}});
  }

  static Plan explain(sqlite3* connection, const std::string& sql) {
    sqlite3_stmt* rows = nullptr;
    EXPECT_EQ(sqlite3_prepare_v2(connection, ("EXPLAIN QUERY PLAN " + sql).c_str(), -1, &rows, nullptr), SQLITE_OK);
    Plan plan;
    while (sqlite3_step(rows) == SQLITE_ROW) {
      plan.emplace_back(reinterpret_cast<const char*>(sqlite3_column_text(rows, 3)));
    }
    sqlite3_finalize(rows);
    return plan;
  }

  // Of the statements about edges or images that a call prepares on a fresh connection.
  Plans plans_of(const std::function<void(const Reader&, const MapLayout&)>& call) {
    store_.reopen();
    const ReadTransaction db = store_.read();
    call(db, load_layout(db, merged_));
    sqlite3* connection = db.connection().handle();
    std::set<std::string> statements;
    for (sqlite3_stmt* s = nullptr; (s = sqlite3_next_stmt(connection, s)) != nullptr;) {
      const std::string sql = sqlite3_sql(s);
      if (sql.find("FROM edges") + sql.find("FROM images") != 2 * std::string::npos) statements.insert(sql);
    }
    Plans plans;
    for (const std::string& sql : statements) plans.insert(explain(connection, sql));
    return plans;
  }

  test::TempStore store_;
  VocabularyId vocabulary_ = test::add_vocabulary(store_);
  MapId a_ = test::add_map(store_, "a", vocabulary_);
  MapId b_ = test::add_map(store_, "b", vocabulary_);
  MapId merged_{};
  JobId job_{};
};

const Plan kFirstBeyondWatermark = {"SEARCH edges USING COVERING INDEX edges_by_later_end (map=? AND v>?)"};
const Plan kInOrder = {"SEARCH edges USING INDEX edges_in_order (map=? AND rowid>? AND rowid<?)"};
// As the image is found, and then its pose.
Plan and_its_pose(const std::string& found) {
  return {found, "CORRELATED SCALAR SUBQUERY 1", "SEARCH image_poses USING INTEGER PRIMARY KEY (rowid=?)"};
}

const Plan kWithheldInOrder = {"SEARCH edges USING INDEX edges_withheld (map=? AND rowid>? AND rowid<?)"};

TEST_F(QueryPlan, EdgesAreListedInTheirOrderFromWhereAPageBegins) {
  for (const std::uint32_t min_inliers : {0U, 50U}) {
    for (const std::optional<bool> confirmed : {std::optional<bool>(), std::optional(true), std::optional(false)}) {
      const EdgeFilter filter{.min_inliers = min_inliers, .confirmed = confirmed};
      const Plans expected = {kFirstBeyondWatermark, confirmed == false ? kWithheldInOrder : kInOrder};
      EXPECT_EQ(plans_of([&](const Reader& db, const MapLayout& layout) { list_edges(db, layout, filter, 10); }),
                expected);
      EXPECT_EQ(plans_of([&](const Reader& db, const MapLayout& layout) { load_edges(db, layout, filter); }), expected);
      EXPECT_EQ(plans_of([&](const Reader& db, const MapLayout& layout) { load_verified_edges(db, layout, filter); }),
                expected);
    }
  }
  EXPECT_EQ(plans_of([&](const Reader& db, const MapLayout&) { list_merge_edges(db, job_, 10); }),
            (Plans{{"SEARCH edges USING INDEX edges_by_job (job=? AND rowid>?)"}}));
  EXPECT_EQ(plans_of([&](const Reader& db, const MapLayout&) { load_merge_edges(db, job_); }),
            (Plans{{"MERGE (UNION ALL)", "LEFT", "SEARCH edges USING INDEX edges_by_job (job=?)", "RIGHT",
                    "SEARCH deleted_edges USING INDEX deleted_edges_by_job (job=?)"}}));
  EXPECT_EQ(plans_of([&](const Reader& db, const MapLayout&) { load_judgements(db, a_); }),
            (Plans{{"SEARCH edges USING INDEX edges_in_order (map=?)"}}));
}

TEST_F(QueryPlan, EdgesOfAVertexAreFoundByTheirEnds) {
  EXPECT_EQ(plans_of([](const Reader& db, const MapLayout& layout) { list_edges_at(db, layout, VertexId{1}); }),
            (Plans{{"SEARCH edges USING INDEX sqlite_autoindex_edges_1 (map=? AND u=?)"},
                   {"SEARCH edges USING INDEX edges_by_later_end (map=? AND v=?)"}}));
  EXPECT_EQ(
      plans_of([](const Reader& db, const MapLayout& layout) { find_edge(db, layout, VertexId{0}, VertexId{1}); }),
      (Plans{{"SEARCH edges USING INDEX sqlite_autoindex_edges_1 (map=? AND u=? AND v=?)"}}));
}

TEST_F(QueryPlan, DegreesAreCountedInIndexesThatHoldThem) {
  const Plans plans =
      plans_of([](const Reader& db, const MapLayout& layout) { count_confirmed_edges_at(db, layout, VertexId{0}, 5); });
  EXPECT_EQ(plans, (Plans{{"SEARCH edges USING COVERING INDEX sqlite_autoindex_edges_1 (map=? AND u>? AND u<?)"},
                          {"SEARCH edges USING COVERING INDEX edges_by_later_end (map=? AND v>? AND v<?)"},
                          {"SEARCH edges USING INDEX edges_withheld_by_earlier_end (map=? AND u>? AND u<?)"},
                          {"SEARCH edges USING INDEX edges_withheld_by_later_end (map=? AND v>? AND v<?)"}}));
  EXPECT_EQ(plans_of([](const Reader& db, const MapLayout& layout) { count_edges(db, layout); }),
            (Plans{{"SEARCH edges USING COVERING INDEX edges_by_later_end (map=? AND v<?)"},
                   {"SEARCH edges USING INDEX edges_withheld_by_later_end (map=? AND v<?)"}}));
}

TEST_F(QueryPlan, VerticesAreListedFromWhereAPageBegins) {
  EXPECT_EQ(
      plans_of([](const Reader& db, const MapLayout& layout) { list_vertices(db, layout, 3, VertexId{1}); }),
      (Plans{and_its_pose("SEARCH images USING INDEX sqlite_autoindex_images_2 (map=? AND vertex>? AND vertex<?)")}));
  EXPECT_EQ(plans_of([](const Reader& db, const MapLayout& layout) { find_vertices(db, layout, "1"); }),
            (Plans{and_its_pose("SEARCH images USING INDEX sqlite_autoindex_images_1 (map=? AND name=?)")}));
  EXPECT_EQ(plans_of([&](const Reader& db, const MapLayout&) { find_vertex(db, a_, VertexId{1}); }),
            (Plans{and_its_pose("SEARCH images USING INDEX sqlite_autoindex_images_2 (map=? AND vertex=?)")}));
  EXPECT_EQ(
      plans_of([&](const Reader& db, const MapLayout&) { list_ignored(db, a_, 3); }),
      (Plans{and_its_pose("SEARCH images USING INDEX sqlite_autoindex_images_2 (map=? AND vertex=? AND rowid>?)")}));
}

}  // namespace
}  // namespace mapweld
