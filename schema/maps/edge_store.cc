#include "schema/maps/edge_store.h"

#include <algorithm>
#include <limits>
#include <stdexcept>
#include <utility>

#include "schema/blobs/evidence_blob.h"
#include "schema/blobs/judgement_blob.h"
#include "schema/maps/edge_rows.h"
#include "schema/rows.h"

namespace mapweld {
namespace {

// How a judgement stands in its columns.
struct JudgementColumns {
  explicit JudgementColumns(const EdgeJudgement& judgement)
      : confirmed(judgement.doubt == Reason::kNone), confidence(judgement.confidence) {
    if (confidence ? !(*confidence >= 0 && *confidence <= 1) : !confirmed) {
      throw StoreError(StoreErrorKind::kConstraint, "an edge is withheld, or believed, by no confidence that there is");
    }
    if (!confirmed) doubt = to_string(judgement.doubt);
    if (!judgement.made_of.empty()) encoded = blobs::encode_judgement(judgement.made_of);
    if (encoded) made_of = *encoded;
  }
  bool confirmed;
  std::optional<double> confidence;
  std::optional<std::string> doubt;
  std::optional<std::span<const std::uint8_t>> made_of;

 private:
  std::optional<blobs::Bytes> encoded;
};

// `column` and the two after it: confidence, doubt, judgement.
EdgeJudgement read_judgement(const sqlite::Statement& row, int column) {
  EdgeJudgement judgement;
  judgement.confidence = row.optional_real(column);
  judgement.doubt = rows::reason(row, column + 1);
  if (!row.is_null(column + 2)) judgement.made_of = blobs::decode_judgement(row.blob(column + 2));
  return judgement;
}

}  // namespace

VerifierId intern_verifier(WriteTransaction& db, std::string_view version, std::string_view parameters) {
  db.prepare("INSERT INTO verifiers (version, parameters) VALUES (?, ?) ON CONFLICT DO NOTHING")
      .bind_all(version, parameters)
      .run();
  sqlite::Statement row = db.prepare("SELECT id FROM verifiers WHERE version = ? AND parameters = ?");
  row.bind_all(version, parameters).step();
  return row.id<VerifierId>(0);
}

void insert_edges(WriteTransaction& db, MapId map, std::span<const NewEdge> edges, VerifierId verifier,
                  std::optional<JobId> job) {
  if (edges.empty()) return;
  sqlite::Statement counted = db.prepare(
      "UPDATE maps SET edges = edges + ?2, revision = revision + ?3, unconfirmed = unconfirmed + ?4 "
      "WHERE id = ?1 AND (kind = 'merged') = ?3 RETURNING vertices");
  const auto unconfirmed =
      std::ranges::count_if(edges, [](const NewEdge& edge) { return edge.judgement.doubt != Reason::kNone; });
  counted.bind_all(map, edges.size(), job.has_value() ? 1 : 0, unconfirmed);
  if (!counted.step()) {
    throw StoreError(StoreErrorKind::kConstraint, "inner edges belong to plain maps, inter edges to merged ones");
  }
  const std::int64_t vertices = counted.integer(0);
  counted.run();
  // As AUTOINCREMENT would number them; all columns in the order of the table, since it reckons the checksum
  // (row_checksums.h).
  std::int64_t id = db.connection().query_integer(
      "SELECT max(ifnull((SELECT seq FROM sqlite_sequence WHERE name = 'edges'), 0), ifnull(max(id), 0)) FROM edges");
  sqlite::Statement is_deleted = db.prepare(
      "SELECT 1 FROM images INDEXED BY images_deleted WHERE map = ? AND vertex = ? AND deleted_at_us IS NOT NULL");
  sqlite::Statement insert = db.prepare(
      "INSERT INTO edges (id, map, u, v, votes, matches, inliers, log10_false_alarms, evidence, verifier, confirmed, "
      "doubt, job, verifications, elapsed_s, confidence, judgement, checksum) VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8, "
      "?9, "
      "?10, ?11, ?12, ?13, ?14, ?15, ?16, ?17, mapweld_checksum('edges', ?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8, ?9, ?10, ?11, "
      "?12, ?13, ?14, ?15, ?16, ?17))");
  for (const NewEdge& edge : edges) {
    if (to_index(edge.v) >= vertices) throw StoreError(StoreErrorKind::kConstraint, "an edge leaves its map");
    if (!job) {
      for (const VertexId end : {edge.u, edge.v}) {
        if (is_deleted.bind_all(map, end).step()) {
          throw StoreError(StoreErrorKind::kConstraint, "an edge of an image that was deleted");
        }
        is_deleted.reset();
      }
    }
    const Verification& verdict = edge.verification;
    const blobs::Bytes evidence = blobs::encode_evidence(verdict);
    const JudgementColumns judgement(edge.judgement);
    insert
        .bind_all(++id, map, edge.u, edge.v, edge.votes, verdict.matches, verdict.inliers, verdict.log10_false_alarms,
                  std::span<const std::uint8_t>(evidence), verifier, judgement.confirmed, judgement.doubt, job,
                  job ? std::optional(edge.verifications) : std::nullopt,
                  job ? std::optional(edge.elapsed_s) : std::nullopt, judgement.confidence, judgement.made_of)
        .run();
  }
}

void delete_inter_edges(WriteTransaction& db, MapId merged) {
  db.prepare("UPDATE maps SET edges = 0, unconfirmed = 0, revision = revision + 1 WHERE id = ? AND kind = 'merged'")
      .bind(1, merged)
      .run();
  if (db.connection().changes() == 0) {
    throw StoreError(StoreErrorKind::kConstraint, "inter edges belong to merged maps");
  }
  for (const char* table : {"edges", "deleted_edges"}) {
    db.prepare("DELETE FROM " + std::string(table) + " WHERE map = ?").bind(1, merged).run();
  }
}

std::vector<EdgeRow> list_merge_edges(const Reader& db, JobId job, std::size_t limit, std::optional<EdgeId> after) {
  sqlite::Statement row =
      db.prepare(rows::select_edges("INDEXED BY edges_by_job WHERE job = ? AND id > ? ORDER BY id LIMIT ?"));
  row.bind_all(job, after.value_or(EdgeId{0}), limit);
  std::vector<EdgeRow> edges;
  while (row.step()) edges.push_back(rows::edge(row));
  return edges;
}

std::vector<NewEdge> load_merge_edges(const Reader& db, JobId job) {
  constexpr std::string_view kOfBoth =
      "u, v, votes, matches, inliers, log10_false_alarms, evidence, verifications, elapsed_s, confidence, doubt, "
      "judgement, id FROM ";
  sqlite::Statement row =
      db.prepare("SELECT " + std::string(kOfBoth) + "edges INDEXED BY edges_by_job WHERE job = ?1 UNION ALL SELECT " +
                 std::string(kOfBoth) + "deleted_edges INDEXED BY deleted_edges_by_job WHERE job = ?1 ORDER BY id");
  row.bind(1, job);
  std::vector<NewEdge> edges;
  while (row.step()) {
    NewEdge& edge = edges.emplace_back();
    edge.u = row.id<VertexId>(0);
    edge.v = row.id<VertexId>(1);
    edge.votes = static_cast<std::uint32_t>(row.integer(2));
    edge.verification.accepted = true;
    edge.verification.matches = static_cast<int>(row.integer(3));
    edge.verification.inliers = static_cast<int>(row.integer(4));
    edge.verification.log10_false_alarms = row.real(5);
    blobs::decode_evidence(row.blob(6), edge.verification);
    edge.verifications = static_cast<std::uint64_t>(row.integer(7));
    edge.elapsed_s = row.real(8);
    edge.judgement = read_judgement(row, 9);
  }
  return edges;
}

EdgeEvidence load_edge_evidence(const Reader& db, EdgeId edge) {
  EdgeEvidence evidence;
  {
    sqlite::Statement row = db.prepare(rows::select_edges("WHERE id = ?"));
    if (!row.bind(1, edge).step()) {
      throw std::out_of_range("there is no edge " + std::to_string(to_index(edge)));
    }
    evidence.edge = rows::edge(row);
  }
  sqlite::Statement row = db.prepare(
      "SELECT matches, evidence, version, parameters, confidence, doubt, judgement "
      "FROM edges JOIN verifiers ON verifiers.id = verifier "
      "WHERE edges.id = ?");
  row.bind(1, edge).step();
  Verification& verdict = evidence.verification;
  verdict.accepted = true;
  verdict.matches = static_cast<int>(row.integer(0));
  verdict.inliers = static_cast<int>(evidence.edge.inliers);
  verdict.log10_false_alarms = evidence.edge.log10_false_alarms;
  blobs::decode_evidence(row.blob(1), verdict);
  evidence.verifier_version = row.text(2);
  evidence.verifier_parameters = row.text(3);
  evidence.made_of = read_judgement(row, 4).made_of;
  return evidence;
}

void set_judgements(WriteTransaction& db, MapId map, std::span<const JudgedEdge> edges) {
  if (edges.empty()) return;
  sqlite::Statement find = db.prepare("SELECT id, confirmed FROM edges WHERE map = ? AND u = ? AND v = ?");
  sqlite::Statement update =
      db.prepare("UPDATE edges SET confirmed = ?2, confidence = ?3, doubt = ?4, judgement = ?5 WHERE id = ?1");
  std::int64_t more_unconfirmed = 0;
  for (const JudgedEdge& edge : edges) {
    const JudgementColumns judgement(edge.judgement);
    if (!find.bind_all(map, edge.u, edge.v).step()) {
      throw StoreError(StoreErrorKind::kConstraint, "an edge is judged that its map does not have");
    }
    const auto id = find.id<EdgeId>(0);
    more_unconfirmed += find.integer(1) - (judgement.confirmed ? 1 : 0);
    find.reset();
    update.bind_all(id, judgement.confirmed, judgement.confidence, judgement.doubt, judgement.made_of).run();
  }
  db.prepare(
        "UPDATE maps SET revision = revision + 1, judgements = judgements + 1, unconfirmed = unconfirmed + ?2 "
        "WHERE id = ?1")
      .bind_all(map, more_unconfirmed)
      .run();
}

bool has_unjudged_edges(const Reader& db, MapId map) {
  sqlite::Statement row = db.prepare("SELECT 1 FROM edges WHERE map = ? AND confidence IS NULL LIMIT 1");
  return row.bind(1, map).step();
}

std::vector<JudgedEdge> load_judgements(const Reader& db, MapId map) {
  sqlite::Statement row = db.prepare(
      "SELECT u, v, confidence, doubt, judgement FROM edges INDEXED BY edges_in_order WHERE map = ? ORDER BY id");
  row.bind(1, map);
  std::vector<JudgedEdge> edges;
  while (row.step()) edges.push_back({row.id<VertexId>(0), row.id<VertexId>(1), read_judgement(row, 2)});
  return edges;
}

}  // namespace mapweld
