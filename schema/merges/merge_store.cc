#include "schema/merges/merge_store.h"

#include <algorithm>
#include <array>
#include <bit>
#include <utility>

#include "schema/blobs/byte_stream.h"
#include "schema/rows.h"

namespace mapweld {
namespace {

constexpr std::size_t kChunkBytes = std::size_t{8} << 20;

constexpr std::array<std::string_view, 7> kStates = {"queued",    "running",   "paused", "budget_exhausted",
                                                     "completed", "cancelled", "failed"};

constexpr std::string_view kColumns =
    "SELECT merges.id, map, name, method, seed, merges.parameters, budget, granted_elapsed_s, granted_verifications, "
    "granted_edges, state, phase, stop_reason, error, epoch, step, elapsed_s, verifications, merges.edges, progress, "
    "checkpoint_at_us, merges.created_at_us, updated_at_us FROM merges JOIN maps ON maps.id = map ";

JobState require_state(std::string_view word) {
  const auto state = parse_job_state(word);
  if (!state) throw StoreError(StoreErrorKind::kCorrupt, "'" + std::string(word) + "' is no state of a job");
  return *state;
}

Spent read_spent(const sqlite::Statement& row, int column) {
  return {row.real(column), static_cast<std::uint64_t>(row.integer(column + 1)),
          static_cast<std::uint64_t>(row.integer(column + 2))};
}

MergeRow read_row(const sqlite::Statement& row) {
  MergeRow merge;
  merge.id = row.id<JobId>(0);
  merge.map = row.id<MapId>(1);
  merge.map_name = row.text(2);
  merge.method = row.text(3);
  merge.seed = std::bit_cast<std::uint64_t>(row.integer(4));
  merge.parameters = row.text(5);
  merge.budget = row.text(6);
  merge.granted_at = read_spent(row, 7);
  merge.state = require_state(row.text(10));
  merge.phase = row.text(11);
  merge.stop_reason = row.optional_text(12);
  merge.error = row.optional_text(13);
  merge.epoch = static_cast<std::uint64_t>(row.integer(14));
  merge.step = static_cast<std::uint64_t>(row.integer(15));
  merge.spent = read_spent(row, 16);
  merge.progress = row.text(19);
  merge.checkpoint_at = rows::optional_timestamp(row, 20);
  merge.created_at = rows::timestamp(row, 21);
  merge.updated_at = rows::timestamp(row, 22);
  return merge;
}

// The merged map of a running job, if `epoch` is its worker's.
std::optional<MapId> map_of_run(const Reader& db, JobId job, std::uint64_t epoch) {
  sqlite::Statement row = db.prepare("SELECT map FROM merges WHERE id = ? AND epoch = ? AND state = 'running'");
  if (!row.bind_all(job, epoch).step()) return std::nullopt;
  return row.id<MapId>(0);
}

void delete_part(WriteTransaction& db, JobId job, const std::string& part) {
  db.prepare("DELETE FROM checkpoints WHERE job = ? AND part = ?").bind_all(job, part).run();
}

void write_part(WriteTransaction& db, JobId job, const CheckpointPart& part) {
  delete_part(db, job, part.name);
  sqlite::Statement insert =
      db.prepare("INSERT INTO checkpoints (job, part, chunk, crc32, bytes) VALUES (?, ?, ?, ?, ?)");
  std::size_t at = 0;
  for (int chunk = 0; chunk == 0 || at < part.bytes.size(); ++chunk) {  // an empty part is a part too
    const auto bytes = part.bytes.subspan(at, std::min(kChunkBytes, part.bytes.size() - at));
    insert.bind_all(job, part.name, chunk, blobs::crc32(bytes), bytes).run();
    at += bytes.size();
  }
}

// Puts parts together from (part, chunk, crc32, bytes), ordered by part and chunk.
std::vector<StoredPart> read_parts(sqlite::Statement& row, JobId job) {
  std::vector<StoredPart> parts;
  std::int64_t next_chunk = 0;
  while (row.step()) {
    if (parts.empty() || parts.back().name != row.text(0)) {
      parts.push_back({std::string(row.text(0)), {}});
      next_chunk = 0;
    }
    const auto bytes = row.blob(3);
    if (row.integer(1) != next_chunk++ || row.integer(2) != blobs::crc32(bytes)) {
      throw StoreError(StoreErrorKind::kCorrupt, "the checkpoint of merge " + std::to_string(to_index(job)) +
                                                     " is damaged in its part '" + parts.back().name + "'");
    }
    parts.back().bytes.insert(parts.back().bytes.end(), bytes.begin(), bytes.end());
  }
  return parts;
}

void write_curve(WriteTransaction& db, JobId job, std::span<const CurvePointRow> points) {
  sqlite::Statement insert = db.prepare(
      "INSERT OR REPLACE INTO curve_points (job, step, elapsed_s, verifications, edges, components, "
      "algebraic_connectivity, largest_vertices, largest_algebraic_connectivity, certified_fraction, phase, confirmed) "
      "VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?)");
  for (const CurvePointRow& p : points) {
    insert
        .bind_all(job, p.step, p.elapsed_s, p.verifications, p.edges, p.components, p.algebraic_connectivity,
                  p.largest_vertices, p.largest_algebraic_connectivity, p.certified_fraction, p.phase, p.confirmed)
        .run();
  }
}

}  // namespace

std::string_view to_string(JobState state) { return kStates[static_cast<std::size_t>(state)]; }

std::optional<JobState> parse_job_state(std::string_view word) {
  const auto found = std::ranges::find(kStates, word);
  if (found == kStates.end()) return std::nullopt;
  return static_cast<JobState>(found - kStates.begin());
}

JobId insert_merge(WriteTransaction& db, const NewMerge& merge) {
  const std::int64_t now = rows::microseconds(merge.created_at);
  db.prepare(
        "INSERT INTO merges (map, method, seed, parameters, budget, state, phase, created_at_us, updated_at_us) "
        "VALUES (?, ?, ?, ?, ?, 'queued', 'voting', ?, ?)")
      .bind_all(merge.map, merge.method, std::bit_cast<std::int64_t>(merge.seed), merge.parameters, merge.budget, now,
                now)
      .run();
  return JobId{db.connection().last_insert_rowid()};
}

std::optional<MergeRow> find_merge(const Reader& db, JobId job) {
  sqlite::Statement row = db.prepare(std::string(kColumns) + "WHERE merges.id = ?");
  if (!row.bind(1, job).step()) return std::nullopt;
  return read_row(row);
}

std::optional<MergeRow> find_merge_of(const Reader& db, MapId merged) {
  sqlite::Statement row = db.prepare(std::string(kColumns) + "WHERE map = ?");
  if (!row.bind(1, merged).step()) return std::nullopt;
  return read_row(row);
}

std::vector<MergeRow> list_merges(const Reader& db, std::size_t limit, std::optional<JobId> after,
                                  std::optional<JobState> state) {
  sqlite::Statement row =
      db.prepare(std::string(kColumns) + (state ? "WHERE merges.id > ? AND state = ?3" : "WHERE merges.id > ?") +
                 " ORDER BY merges.id LIMIT ?2");
  row.bind_all(after.value_or(JobId{0}), limit);
  if (state) row.bind(3, to_string(*state));
  std::vector<MergeRow> merges;
  while (row.step()) merges.push_back(read_row(row));
  return merges;
}

std::map<JobState, std::uint64_t> count_merges(const Reader& db) {
  std::map<JobState, std::uint64_t> counts;
  sqlite::Statement row = db.prepare("SELECT count(*) FROM merges WHERE state = ?");
  for (const JobState state : kJobStates) {
    row.bind(1, to_string(state)).step();
    counts[state] = static_cast<std::uint64_t>(row.integer(0));
    row.reset();
  }
  return counts;
}

std::optional<std::uint64_t> claim_merge(WriteTransaction& db, JobId job, Timestamp now) {
  sqlite::Statement row = db.prepare(
      "UPDATE merges SET state = 'running', stop_reason = NULL, error = NULL, epoch = epoch + 1, updated_at_us = ? "
      "WHERE id = ? AND state = 'queued' RETURNING epoch");
  if (!row.bind_all(rows::microseconds(now), job).step()) return std::nullopt;
  const auto epoch = static_cast<std::uint64_t>(row.integer(0));
  row.run();
  return epoch;
}

bool requeue_merge(WriteTransaction& db, JobId job, std::optional<std::string> budget, Timestamp now) {
  db.prepare(
        "UPDATE merges SET state = 'queued', stop_reason = NULL, error = NULL, epoch = epoch + 1, updated_at_us = ?2 "
        "WHERE id = ?1")
      .bind_all(job, rows::microseconds(now))
      .run();
  if (db.connection().changes() == 0) return false;
  if (budget) {
    db.prepare(
          "UPDATE merges SET budget = ?2, granted_elapsed_s = elapsed_s, granted_verifications = verifications, "
          "granted_edges = edges WHERE id = ?1")
        .bind_all(job, *budget)
        .run();
  }
  return true;
}

bool restart_merge(WriteTransaction& db, JobId job, std::optional<std::string> budget, Timestamp now) {
  const auto merge = find_merge(db, job);
  if (!merge) return false;
  delete_inter_edges(db, merge->map);
  for (const std::string_view table : {"checkpoints", "curve_points"}) {
    db.prepare("DELETE FROM " + std::string(table) + " WHERE job = ?").bind(1, job).run();
  }
  db.prepare(
        "UPDATE merges SET state = 'queued', phase = 'voting', stop_reason = NULL, error = NULL, epoch = epoch + 1, "
        "step = 0, elapsed_s = 0, verifications = 0, edges = 0, granted_elapsed_s = 0, granted_verifications = 0, "
        "granted_edges = 0, progress = '{}', checkpoint_at_us = NULL, budget = coalesce(?2, budget), "
        "updated_at_us = ?3 WHERE id = ?1")
      .bind_all(job, budget, rows::microseconds(now))
      .run();
  return true;
}

std::uint64_t granted_edges_in(std::uint64_t granted, std::uint64_t before, std::uint64_t after) {
  return granted + after - std::min(granted + after, before);
}

bool save_checkpoint(WriteTransaction& db, JobId job, std::uint64_t epoch, const CheckpointWrite& checkpoint) {
  const auto map = map_of_run(db, job, epoch);
  if (!map) return false;
  db.prepare(
        "UPDATE merges SET step = ?2, phase = ?3, elapsed_s = ?4, verifications = ?5, edges = ?6, "
        "granted_edges = max(0, granted_edges + ?6 - ?9 - edges), "
        "progress = coalesce(?7, progress), checkpoint_at_us = ?8, updated_at_us = ?8 WHERE id = ?1")
      .bind_all(job, checkpoint.step, checkpoint.phase, checkpoint.spent.elapsed_s, checkpoint.spent.verifications,
                checkpoint.spent.edges, checkpoint.progress, rows::microseconds(checkpoint.now),
                checkpoint.edges.size())
      .run();
  for (const std::string& part : checkpoint.dropped_parts) delete_part(db, job, part);
  for (const CheckpointPart& part : checkpoint.parts) write_part(db, job, part);
  insert_edges(db, *map, checkpoint.edges, checkpoint.verifier, job);
  write_curve(db, job, checkpoint.curve_points);
  return true;
}

void rewrite_checkpoint(WriteTransaction& db, JobId job, std::span<const CheckpointPart> parts, std::uint64_t edges) {
  for (const CheckpointPart& part : parts) write_part(db, job, part);
  db.prepare("UPDATE merges SET edges = ?1, granted_edges = max(0, granted_edges + ?1 - edges) WHERE id = ?2")
      .bind_all(edges, job)
      .run();
}

std::vector<StoredPart> load_checkpoint(const Reader& db, JobId job) {
  sqlite::Statement row =
      db.prepare("SELECT part, chunk, crc32, bytes FROM checkpoints WHERE job = ? ORDER BY part, chunk");
  row.bind(1, job);
  return read_parts(row, job);
}

std::optional<StoredPart> load_checkpoint_part(const Reader& db, JobId job, std::string_view part) {
  sqlite::Statement row =
      db.prepare("SELECT part, chunk, crc32, bytes FROM checkpoints WHERE job = ? AND part = ? ORDER BY chunk");
  row.bind_all(job, part);
  std::vector<StoredPart> parts = read_parts(row, job);
  if (parts.empty()) return std::nullopt;
  return std::move(parts.front());
}

bool end_run(WriteTransaction& db, JobId job, std::uint64_t epoch, const RunEnd& end) {
  if (!map_of_run(db, job, epoch)) return false;
  return set_merge_state(db, job, JobState::kRunning, end);
}

bool set_merge_state(WriteTransaction& db, JobId job, JobState expected, const RunEnd& end) {
  db.prepare(
        "UPDATE merges SET state = ?, stop_reason = ?, error = ?, epoch = epoch + 1, updated_at_us = ? "
        "WHERE id = ? AND state = ?")
      .bind_all(to_string(end.state), end.stop_reason, end.error, rows::microseconds(end.now), job, to_string(expected))
      .run();
  return db.connection().changes() > 0;
}

std::vector<CurvePointRow> list_curve(const Reader& db, JobId job, std::size_t limit,
                                      std::optional<std::uint64_t> after_step) {
  sqlite::Statement row = db.prepare(
      "SELECT step, elapsed_s, verifications, edges, components, algebraic_connectivity, largest_vertices, "
      "largest_algebraic_connectivity, certified_fraction, phase, confirmed FROM curve_points "
      "WHERE job = ? AND step > ? ORDER BY step LIMIT ?");
  row.bind(1, job).bind(2, after_step ? static_cast<std::int64_t>(*after_step) : -1).bind(3, limit);
  std::vector<CurvePointRow> points;
  while (row.step()) {
    CurvePointRow& p = points.emplace_back();
    p.step = static_cast<std::uint64_t>(row.integer(0));
    p.elapsed_s = row.real(1);
    p.verifications = static_cast<std::uint64_t>(row.integer(2));
    p.edges = static_cast<std::uint64_t>(row.integer(3));
    p.components = static_cast<std::uint32_t>(row.integer(4));
    p.algebraic_connectivity = row.real(5);
    p.largest_vertices = static_cast<std::uint32_t>(row.integer(6));
    p.largest_algebraic_connectivity = row.real(7);
    p.certified_fraction = row.optional_real(8);
    p.phase = row.text(9);
    if (!row.is_null(10)) p.confirmed = static_cast<std::uint64_t>(row.integer(10));
  }
  return points;
}

DeleteOutcome delete_merge(WriteTransaction& db, JobId job) {
  const auto merge = find_merge(db, job);
  if (!merge) return DeleteOutcome::kNotFound;
  return delete_map(db, merge->map);
}

std::vector<JobId> recover_merges(WriteTransaction& db, Timestamp now) {
  db.prepare("UPDATE merges SET state = 'queued', epoch = epoch + 1, updated_at_us = ? WHERE state = 'running'")
      .bind(1, rows::microseconds(now))
      .run();
  std::vector<JobId> queued;
  sqlite::Statement row = db.prepare("SELECT id FROM merges WHERE state = 'queued' ORDER BY id");
  while (row.step()) queued.push_back(row.id<JobId>(0));
  return queued;
}

}  // namespace mapweld
