#include "schema/store_check.h"

#include <algorithm>
#include <optional>
#include <utility>

#include <openssl/sha.h>

#include "schema/blobs/appearance_blob.h"
#include "schema/blobs/evidence_blob.h"
#include "schema/blobs/judgement_blob.h"
#include "schema/engine/migrations.h"
#include "schema/maps/absent_vertices.h"
#include "schema/maps/edge_store.h"
#include "schema/maps/map_layout.h"
#include "schema/maps/vertex_store.h"
#include "schema/maps/vocabulary_store.h"
#include "schema/merges/merge_state_check.h"
#include "schema/merges/merge_store.h"
#include "schema/rows.h"
#include "schema/segments/segment_postings.h"

namespace mapweld {
namespace {

Sha256 hash_of(std::span<const std::uint8_t> bytes) {
  Sha256 hash{};
  SHA256(bytes.data(), bytes.size(), hash.data());
  return hash;
}

std::string number(std::uint64_t value) { return std::to_string(value); }

// What helps a merge whose state is damaged.
constexpr const char* kRestart = "; restart the merge";

// Enough findings: the rest is not looked at.
struct Enough {};

class Checker {
 public:
  Checker(const Reader& db, const StoreCheckOptions& options) : db_(db), options_(options) {}

  StoreCheckReport run() {
    try {
      part("database file", [this] {
        check_integrity(db_.connection(), "database file", tell_);
        check_schema(db_.connection(), migrations(), "database file", tell_);
        check_numbers(db_.connection(), tell_);
      });
      part("rows", [this] { check_rows(db_.connection(), tell_); });
      part("vocabularies", [this] { check_vocabularies(); });
      part("maps", [this] { check_maps(); });
      part("images", [this] {
        check_images();
        check_masks();
        check_cameras();
      });
      part("appearances", [this] { check_appearances(); });
      part("segments", [this] { check_segments(); });
      part("edges", [this] { check_edges(); });
      part("merges", [this] { check_merges(); });
      part("key_usage", [this] {
        findings_of(
            "SELECT 'key_usage: key ' || key, 'its numbers are not those of its images' FROM (SELECT key, images, "
            "bytes "
            "FROM key_usage UNION ALL SELECT key, -count(*), -sum(bytes) FROM owned_images GROUP BY key) GROUP BY key "
            "HAVING sum(images) <> 0 OR sum(bytes) <> 0");
      });
    } catch (const Enough&) {
    }
    return std::move(report_);
  }

 private:
  void found(std::string where, std::string what) {
    report_.findings.push_back({std::move(where), std::move(what)});
    if (report_.findings.size() >= options_.max_findings) throw Enough();
  }

  void expect(bool holds, const std::string& where, const std::string& what) {
    if (!holds) found(where, what);
  }

  // Runs a check in which damage may throw, and takes the exception down as a finding.
  template <typename Check>
  void guarded(const std::string& where, Check&& check, const std::string& remedy = {}) {
    std::optional<std::string> what;
    try {
      check();
    } catch (const StoreError& error) {
      // A defect of the program; or of tables and values that are damaged.
      if (error.kind() == StoreErrorKind::kInternal && report_.findings.empty()) throw;
      what = error.what();
    } catch (const std::exception& error) {
      what = error.what();
    }
    if (what) found(where, *what + remedy);
  }

  template <typename Check>
  void part(const std::string& name, Check&& check) {
    if (options_.on_progress) options_.on_progress(name);
    guarded(name, check);
  }

  // Every row of `sql` is a finding: where, what.
  void findings_of(std::string_view sql) {
    sqlite::Statement row = db_.prepare(sql);
    while (row.step()) found(std::string(row.text(0)), std::string(row.text(1)));
  }

  void check_vocabularies() {
    for (const VocabularyRow& vocabulary : list_vocabularies(db_, SIZE_MAX >> 1)) {
      const std::string where = "vocabularies: " + vocabulary.name;
      guarded(where, [&] {
        expect(hash_of(load_vocabulary_file(db_, vocabulary.id)) == vocabulary.sha256, where,
               "its file has another SHA-256 than its row");
      });
    }
  }

  void check_maps() {
    report_.maps = static_cast<std::uint64_t>(db_.connection().query_integer("SELECT count(*) FROM maps"));
    findings_of(
        "SELECT 'maps: ' || name, 'it counts ' || vertices || ' vertices, and has ' || n || ' up to number ' || last "
        "FROM "
        "(SELECT maps.name AS name, vertices, count(vertex) AS n, coalesce(max(vertex), -1) AS last FROM maps "
        " LEFT JOIN (SELECT map, vertex FROM images WHERE vertex IS NOT NULL UNION ALL SELECT map, vertex FROM "
        " purged_vertices) given ON given.map = maps.id WHERE kind = 'map' GROUP BY maps.id) "
        "WHERE vertices <> n OR vertices <> last + 1");
    findings_of(
        "SELECT 'maps: ' || name, 'it counts ' || ignored || ' ignored images, and has ' || n FROM "
        "(SELECT name, ignored, (SELECT count(*) FROM images WHERE images.map = maps.id AND vertex IS NULL) AS n FROM "
        "maps) "
        "WHERE ignored <> n");
    findings_of(
        "SELECT 'maps: ' || name, 'it counts ' || edges || ' edges, and has ' || n FROM "
        "(SELECT name, edges, (SELECT count(*) FROM edges WHERE edges.map = maps.id) AS n FROM maps) WHERE edges <> n");
    findings_of(
        "SELECT 'maps: ' || name, 'it counts ' || unconfirmed || ' unconfirmed edges, and has ' || n FROM "
        "(SELECT name, unconfirmed, (SELECT count(*) FROM edges WHERE edges.map = maps.id AND confirmed = 0) AS n "
        "FROM maps) WHERE unconfirmed <> n");
    findings_of(
        "SELECT 'maps: ' || m.name, 'it counts ' || m.vertices || ' vertices, and its spans ' || "
        " coalesce(sum(count), 0) FROM maps m LEFT JOIN member_spans ON merged = m.id WHERE m.kind = 'merged' "
        "GROUP BY m.id HAVING m.vertices <> coalesce(sum(count), 0)");
    findings_of(
        "SELECT 'member_spans: map ' || merged || ', span ' || span, 'it does not follow the span before it' FROM "
        "(SELECT merged, span, first_vertex, first_member_vertex, "
        "  sum(count) OVER (PARTITION BY merged ORDER BY span) - count AS expected, "
        "  sum(count) OVER (PARTITION BY merged, member ORDER BY span) - count AS expected_member FROM member_spans) "
        "WHERE first_vertex <> expected OR first_member_vertex <> expected_member");
    findings_of(
        "SELECT 'member_spans: map ' || merged, 'its member ' || m.name || ' has fewer vertices than its watermark' "
        "FROM member_spans JOIN maps m ON m.id = member GROUP BY merged, member HAVING sum(count) > m.vertices");
    findings_of(
        "SELECT 'member_spans: map ' || merged, 'its member ' || member || ' is younger than itself' FROM member_spans "
        "WHERE member >= merged");
    findings_of(
        "SELECT 'maps: ' || m.name, 'its member ' || o.name || ' has another vocabulary' FROM member_spans "
        "JOIN maps m ON m.id = merged JOIN maps o ON o.id = member WHERE m.vocabulary <> o.vocabulary");
  }

  void check_images() {
    report_.images = static_cast<std::uint64_t>(db_.connection().query_integer("SELECT count(*) FROM images"));
    findings_of(
        "SELECT 'images: map ' || map || ', ' || images.name, 'it was ignored for vertex ' || similar_to || ', which "
        "is not "
        "there' "
        "FROM images JOIN maps ON maps.id = map WHERE similar_to >= vertices");
    sqlite::Statement row =
        db_.prepare("SELECT map, name, sha256, bytes FROM images JOIN image_bytes ON image = images.id");
    while (row.step()) {
      expect(hash_of(row.blob(3)) == rows::sha256(row, 2),
             "image_bytes: map " + number(static_cast<std::uint64_t>(row.integer(0))) + ", " + std::string(row.text(1)),
             "the bytes have another SHA-256 than when they were uploaded");
    }
  }

  void check_masks() {
    sqlite::Statement row = db_.prepare("SELECT name, kind, sha256, bytes FROM map_masks JOIN maps ON id = map");
    while (row.step()) {
      const std::string where = "map_masks: " + std::string(row.text(0));
      expect(hash_of(row.blob(3)) == rows::sha256(row, 2), where, "its bytes have another SHA-256 than its row");
      expect(row.text(1) == "map", where, "a merged map has none");
    }
  }

  void check_cameras() {
    findings_of(
        "SELECT 'map_cameras: ' || name, 'a merged map has none' FROM map_cameras JOIN maps ON id = map "
        "WHERE kind <> 'map'");
  }

  void check_appearances() {
    findings_of(
        "SELECT 'appearances: map ' || images.map || ', vertex ' || images.vertex, 'there are none' FROM images "
        "JOIN maps ON maps.id = images.map LEFT JOIN appearances a ON a.map = images.map AND a.vertex = images.vertex "
        "AND "
        "a.vocabulary = maps.vocabulary WHERE images.vertex IS NOT NULL AND deleted_at_us IS NULL AND a.bytes IS NULL");
    sqlite::Statement row = db_.prepare(
        "SELECT a.map, a.vertex, a.bytes, width_px, height_px, features, words, static_features FROM appearances a "
        "JOIN images i ON i.map = a.map AND i.vertex = a.vertex JOIN vocabularies v ON v.id = a.vocabulary");
    while (row.step()) {
      const std::string where = "appearances: map " + number(static_cast<std::uint64_t>(row.integer(0))) + ", vertex " +
                                number(static_cast<std::uint64_t>(row.integer(1)));
      guarded(where, [&] {
        const AppearanceVector image = blobs::decode_appearances(row.blob(2));
        expect(image.width_px == row.integer(3) && image.height_px == row.integer(4), where,
               "they are of an image of another size");
        const std::size_t fixed = image.static_appearances.size();
        const std::size_t all = image.appearances.size() + fixed;
        expect(static_cast<std::int64_t>(all) == row.integer(5), where,
               "there are " + number(all) + ", and the image has " +
                   number(static_cast<std::uint64_t>(row.integer(5))) + " features");
        expect(static_cast<std::int64_t>(fixed) == row.integer(7), where,
               number(fixed) + " of them are static, and the image counts " +
                   number(static_cast<std::uint64_t>(row.integer(7))));
        for (const auto* list : {&image.appearances, &image.static_appearances}) {
          expect(list->empty() || to_index(list->back().word) < row.integer(6), where,
                 "a word is not in the vocabulary");
        }
      });
      ++report_.appearances;
    }
  }

  void check_segments() {
    sqlite::Statement owner = db_.prepare(
        "SELECT DISTINCT map, segments.vocabulary, vertices FROM segments JOIN maps ON maps.id = map ORDER BY 1, 2");
    while (owner.step()) {
      const auto map = owner.id<MapId>(0);
      const auto vocabulary = owner.id<VocabularyId>(1);
      std::uint64_t next = 0;
      for (const SegmentRow& segment : list_segments(db_, map, vocabulary)) {
        const std::string where = "segments: map " + number(static_cast<std::uint64_t>(to_index(map))) +
                                  ", from vertex " + number(to_index(segment.first));
        expect(to_index(segment.first) == next, where, "it does not follow the segment before it");
        next = std::uint64_t{to_index(segment.first)} + segment.count;
        expect(static_cast<std::int64_t>(next) <= owner.integer(2), where, "it reaches beyond the map");
        guarded(where, [&] {
          const auto expected = invert_appearances(db_, map, vocabulary, segment.first, segment.count);
          expect(expected.has_value(), where, "a vertex in it has no appearances");
          expect(!expected || read_segment(db_, segment) == *expected, where,
                 "its postings are not those of the appearances");
        });
        ++report_.segments;
      }
    }
  }

  // What edges of a map, of any level of merging, may be between.
  struct Ends {
    std::vector<std::uint32_t> features;  // of each vertex, those that can match; of a purged one none
    VertexSet absent;
  };
  Ends ends_of(MapId map) {
    Ends ends;
    const MapLayout layout = load_layout(db_, map);
    ends.features.resize(layout.vertices());
    ends.absent = absent_vertices(db_, layout);
    for (const MapLayout::LeafSpan& span : layout.leaf_spans()) {
      sqlite::Statement row = db_.prepare(
          "SELECT vertex, features - static_features FROM images WHERE map = ? AND vertex >= ? AND vertex < ?");
      const std::uint64_t first = to_index(span.leaf_first);
      row.bind_all(span.leaf, first, first + span.count);
      while (row.step()) {
        ends.features[to_index(span.first) + static_cast<std::size_t>(row.integer(0)) - first] =
            static_cast<std::uint32_t>(row.integer(1));
      }
    }
    return ends;
  }

  void check_edges() {
    findings_of(
        "SELECT 'edges: ' || edges.id, 'its merge is not the one that made its map' FROM edges "
        "LEFT JOIN merges ON merges.id = job WHERE job IS NOT NULL AND merges.map IS NOT edges.map");
    findings_of(
        "SELECT 'edges: ' || edges.id, 'an inner edge in a merged map, or an inter edge in a plain one' FROM edges "
        "JOIN maps ON maps.id = map WHERE (job IS NOT NULL) <> (kind = 'merged')");
    findings_of(
        "SELECT 'edges: ' || id, 'it is not confirmed, and nobody has judged it' FROM edges "
        "WHERE confirmed = 0 AND confidence IS NULL");
    findings_of(
        "SELECT 'edges: ' || e.id, 'it is ' || iif(e.confirmed, '', 'not ') || 'confirmed with a confidence of ' || "
        " e.confidence || ', where its merge asks for ' || json_extract(m.parameters, '$.min_confidence') "
        "FROM edges e JOIN merges m ON m.id = e.job "
        "WHERE e.confirmed <> (e.confidence >= json_extract(m.parameters, '$.min_confidence'))");
    findings_of(
        "SELECT 'edges: ' || e.id, 'it has ' || e.votes || ' votes, where its merge asks for ' || "
        " json_extract(m.parameters, '$.min_votes') FROM edges e JOIN merges m ON m.id = e.job "
        "WHERE e.votes < json_extract(m.parameters, '$.min_votes')");
    for (const char* table : {"edges", "deleted_edges"}) check_edges_of(table);
  }

  void check_edges_of(const std::string& table) {
    const bool of_deleted = table == "deleted_edges";
    sqlite::Statement owner = db_.prepare("SELECT DISTINCT map FROM " + table + " ORDER BY map");
    while (owner.step()) {
      Ends ends;
      guarded(table + ": map " + number(static_cast<std::uint64_t>(owner.integer(0))),
              [&] { ends = ends_of(owner.id<MapId>(0)); });
      sqlite::Statement row =
          db_.prepare("SELECT id, u, v, inliers, evidence, judgement FROM " + table + " WHERE map = ?");
      row.bind(1, owner.integer(0));
      while (row.step()) {
        const std::string where = table + ": " + number(static_cast<std::uint64_t>(row.integer(0)));
        const auto u = static_cast<std::uint64_t>(row.integer(1));
        const auto v = static_cast<std::uint64_t>(row.integer(2));
        ++report_.edges;
        expect(v < ends.features.size(), where, "one of its vertices does not exist");
        if (v >= ends.features.size()) continue;
        const bool has_deleted_end = ends.absent.contains(VertexId{static_cast<std::uint32_t>(u)}) ||
                                     ends.absent.contains(VertexId{static_cast<std::uint32_t>(v)});
        expect(has_deleted_end == of_deleted, where,
               of_deleted ? "none of its vertices is deleted" : "one of its vertices is deleted");
        guarded(where, [&] {
          Verification verdict;
          blobs::decode_evidence(row.blob(4), verdict);
          const auto& matches = verdict.inlier_matches;
          expect(matches.empty() || static_cast<std::int64_t>(matches.size()) == row.integer(3), where,
                 "it has not as many matches as inliers");
          const auto has = [&](const auto& match) {
            return match.first < ends.features[u] && match.second < ends.features[v];
          };
          expect(std::ranges::all_of(matches, has), where, "a match names a feature that its image does not have");
          if (!row.is_null(5)) blobs::decode_judgement(row.blob(5));
        });
      }
    }
  }

  void check_merges() {
    findings_of(
        "SELECT 'merges: ' || merges.id, 'its map is no merged map' FROM merges JOIN maps ON maps.id = map "
        "WHERE kind <> 'merged'");
    report_.checkpoints = static_cast<std::uint64_t>(
        db_.connection().query_integer("SELECT count(*) FROM (SELECT DISTINCT job, part FROM checkpoints)"));
    for (const MergeRow& merge : list_merges(db_, SIZE_MAX >> 1)) {
      const std::string where = where_of_checkpoint(merge.id);
      guarded(
          where,
          [&] {
            for (const std::string& what : check_merge_state(db_, merge)) found(where, what + kRestart);
          },
          kRestart);
    }
  }

  const Reader& db_;
  const StoreCheckOptions& options_;
  const TellFinding tell_ = [this](Finding finding) { found(std::move(finding.where), std::move(finding.what)); };
  StoreCheckReport report_;
};

}  // namespace

std::string where_of_checkpoint(JobId job) { return "checkpoints: merge " + std::to_string(to_index(job)); }

StoreCheckReport check_store(const Reader& db, const StoreCheckOptions& options) { return Checker(db, options).run(); }

}  // namespace mapweld
