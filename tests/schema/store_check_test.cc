#include "schema/store_check.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/schema/every_table.h"

namespace mapweld {
namespace {

using test::TempStore;
using testing::HasSubstr;

class StoreCheckTest : public testing::Test {
 protected:
  // What is found after `damage`, which is not kept.
  std::vector<Finding> found_after(const std::string& damage) {
    WriteTransaction db = store_.write();
    db.connection().execute("PRAGMA defer_foreign_keys = ON; PRAGMA ignore_check_constraints = ON;" + damage);
    db.connection().execute("PRAGMA ignore_check_constraints = OFF");
    return check_store(db).findings;
  }

  TempStore store_;
  const test::EveryTable filled_{store_};
};

TEST_F(StoreCheckTest, AWholeStoreHasNoFindingsAndIsCounted) {
  std::vector<std::string> parts;
  StoreCheckOptions options;
  options.on_progress = [&](std::string_view part) { parts.emplace_back(part); };
  const StoreCheckReport report = check_store(store_.read(), options);
  EXPECT_TRUE(report.findings.empty()) << report.findings[0].where << ": " << report.findings[0].what;
  EXPECT_EQ(report.maps, 3U);
  EXPECT_EQ(report.images, 42U);
  EXPECT_EQ(report.appearances, 41U);
  EXPECT_EQ(report.segments, 2U);
  EXPECT_EQ(report.edges, 40U);
  EXPECT_EQ(report.checkpoints, 4U);
  EXPECT_EQ(parts.size(), 10U);
}

TEST_F(StoreCheckTest, EveryKindOfDamageIsFoundWhereItIs) {
  const std::vector<std::pair<std::string, std::string>> damages = {
      {"UPDATE vocabulary_chunks SET bytes = CAST(bytes || x'00' AS BLOB)", "vocabularies: words"},
      {"DELETE FROM vocabulary_chunks", "vocabularies: words"},
      {"UPDATE maps SET vertices = vertices + 1 WHERE name = 'a'", "maps: a"},
      {"UPDATE maps SET ignored = 0 WHERE name = 'a'", "maps: a"},
      {"UPDATE maps SET edges = edges + 1 WHERE name = 'b'", "maps: b"},
      {"UPDATE maps SET unconfirmed = 1 WHERE name = 'b'", "maps: b"},
      {"UPDATE maps SET vertices = 39 WHERE name = 'ab'", "maps: ab"},
      {"UPDATE member_spans SET first_vertex = 19 WHERE span = 1", "member_spans: map 3, span 1"},
      {"UPDATE member_spans SET first_member_vertex = 1 WHERE span = 1", "member_spans: map 3, span 1"},
      {"UPDATE member_spans SET count = 25 WHERE span = 1", "member_spans: map 3"},
      {"UPDATE member_spans SET member = 3 WHERE span = 1", "member_spans: map 3"},
      {"DELETE FROM images WHERE vertex = 7 AND map = 2", "maps: b"},
      {"UPDATE images SET similar_to = 99 WHERE vertex IS NULL", "images: map 1, ignored"},
      {"UPDATE image_bytes SET bytes = CAST(bytes || x'00' AS BLOB) WHERE image = 5", "image_bytes: map 1, 4"},
      {"UPDATE map_masks SET bytes = CAST(bytes || x'00' AS BLOB)", "map_masks: a"},
      {"UPDATE map_masks SET map = 3", "map_masks: ab"},
      {"UPDATE map_cameras SET map = 3", "map_cameras: ab"},
      {"DELETE FROM appearances WHERE map = 1 AND vertex = 18", "appearances: map 1, vertex 18"},
      {"UPDATE appearances SET bytes = CAST(bytes || x'00' AS BLOB) WHERE map = 2 AND vertex = 3",
       "appearances: map 2, vertex 3"},
      {"UPDATE images SET features = 41 WHERE map = 2 AND vertex = 3", "appearances: map 2, vertex 3"},
      {"UPDATE images SET static_features = 1 WHERE map = 2 AND vertex = 3", "appearances: map 2, vertex 3"},
      {"UPDATE images SET width_px = 41 WHERE map = 2 AND vertex = 3", "appearances: map 2, vertex 3"},
      {"UPDATE vocabularies SET words = 10", "appearances: map 1"},
      // Two images change places: every blob is whole, but the segments are of the other order.
      {"UPDATE appearances SET bytes = (SELECT bytes FROM appearances WHERE map = 1 AND vertex = 5) "
       "WHERE map = 1 AND vertex = 4",
       "segments: map 1, from vertex 0"},
      {"UPDATE posting_blocks SET bytes = CAST(bytes || x'00' AS BLOB)", "segments: map 1, from vertex 0"},
      {"DELETE FROM posting_blocks WHERE segment = (SELECT id FROM segments WHERE map = 2)",
       "segments: map 2, from vertex 0"},
      {"UPDATE segments SET first_vertex = 1 WHERE map = 2", "segments: map 2, from vertex 1"},
      {"UPDATE edges SET evidence = CAST(evidence || x'00' AS BLOB) WHERE id = 9", "edges: 9"},
      {"UPDATE edges SET judgement = x'4A01' WHERE id = 9", "edges: 9"},
      {"UPDATE edges SET confirmed = 0, doubt = 'unsupported' WHERE id = 9", "edges: 9"},
      {"UPDATE edges SET confidence = 0.5 WHERE id = 39; UPDATE merges SET parameters = '{\"min_confidence\":0.75}'",
       "edges: 39"},
      {"UPDATE edges SET inliers = 3 WHERE id = 9", "edges: 9"},
      {"UPDATE edges SET v = 20 WHERE id = 19", "edges: 19"},
      {"UPDATE edges SET map = 2, u = 0, v = 19 WHERE id = 39", "edges: 39"},
      {"UPDATE edges SET verifier = 99 WHERE id = 9", "edges: row 9"},
      {"UPDATE merges SET map = 1", "merges: 1"},
      {"UPDATE edges SET votes = 3 WHERE id = 39; UPDATE merges SET parameters = '{\"min_votes\":4}'", "edges: 39"},
      {"UPDATE checkpoints SET bytes = x'00'", "checkpoints: merge 1"},
  };
  for (const auto& [damage, where] : damages) {
    const auto findings = found_after(damage);
    EXPECT_THAT(findings, testing::Contains(testing::Field(&Finding::where, HasSubstr(where)))) << damage;
  }
  EXPECT_TRUE(check_store(store_.read()).findings.empty());
}

TEST_F(StoreCheckTest, ItStopsWhenItHasFoundEnough) {
  WriteTransaction db = store_.write();
  db.connection().execute("UPDATE appearances SET bytes = x'00'");
  StoreCheckOptions options;
  options.max_findings = 3;
  EXPECT_EQ(check_store(db, options).findings.size(), 3U);
}

}  // namespace
}  // namespace mapweld
