-- The first schema. docs/storage.md describes the tables and the formats of the blobs.
--
-- Conventions: *_us are microseconds since 1970 in UTC; *_s seconds; booleans are 0 or 1; JSON is kept as it was given.
-- AUTOINCREMENT stands where a number is shown outside and must never come back after a deletion.

-- The visual vocabularies, immutable. Their files are cut into chunks, since a blob cannot exceed 1 GB.
CREATE TABLE vocabularies (
  id INTEGER PRIMARY KEY AUTOINCREMENT,
  name TEXT NOT NULL UNIQUE CHECK (length(name) BETWEEN 1 AND 64),
  words INTEGER NOT NULL CHECK (words > 0),
  dimension INTEGER NOT NULL CHECK (dimension > 0),
  descriptor TEXT NOT NULL,                          -- what the words are made of: 'sift-u8'
  engine TEXT NOT NULL,                              -- of the index in the file: 'hnsw', 'flann', 'exact'
  sha256 BLOB NOT NULL CHECK (length(sha256) = 32),  -- of the file
  file_bytes INTEGER NOT NULL,
  created_at_us INTEGER NOT NULL
) STRICT;

CREATE TABLE vocabulary_chunks (
  vocabulary INTEGER NOT NULL REFERENCES vocabularies (id) ON DELETE CASCADE,
  chunk INTEGER NOT NULL,
  bytes BLOB NOT NULL,
  PRIMARY KEY (vocabulary, chunk)
) STRICT;

-- Plain maps own images, appearances, segments and inner edges; merged maps own member spans and inter edges.
CREATE TABLE maps (
  id INTEGER PRIMARY KEY AUTOINCREMENT,
  uuid TEXT NOT NULL UNIQUE CHECK (length(uuid) = 36),
  name TEXT NOT NULL UNIQUE CHECK (length(name) BETWEEN 1 AND 64),
  kind TEXT NOT NULL CHECK (kind IN ('map', 'merged')),
  vocabulary INTEGER NOT NULL REFERENCES vocabularies (id),
  parameters TEXT NOT NULL CHECK (json_valid(parameters)),
  labels TEXT NOT NULL CHECK (json_valid(labels)),
  created_at_us INTEGER NOT NULL,
  revision INTEGER NOT NULL DEFAULT 0,
  vertices INTEGER NOT NULL DEFAULT 0,  -- numbers given; the next vertex gets this one
  edges INTEGER NOT NULL DEFAULT 0,     -- rows in `edges`
  ignored INTEGER NOT NULL DEFAULT 0    -- images that were not inserted
) STRICT;
CREATE INDEX maps_by_vocabulary ON maps (vocabulary);

-- How a merged map numbers its members' vertices: [first_vertex, +count) are the member's [first_member_vertex, +count).
-- Spans follow one another in the order of `span`. Each member has one in the first round, an empty one too; what members
-- gained later is appended. No cascade from the member: a map that is named here cannot be deleted.
CREATE TABLE member_spans (
  merged INTEGER NOT NULL REFERENCES maps (id) ON DELETE CASCADE,
  span INTEGER NOT NULL,
  member INTEGER NOT NULL REFERENCES maps (id),
  first_vertex INTEGER NOT NULL,
  first_member_vertex INTEGER NOT NULL,
  count INTEGER NOT NULL CHECK (count >= 0),
  PRIMARY KEY (merged, span),
  CHECK (member < merged)  -- a map is made after its members: no circles
) STRICT, WITHOUT ROWID;
CREATE INDEX member_spans_by_member ON member_spans (member);

-- Every image that a plain map has taken: as a vertex, or ignored (vertex IS NULL). One table, so that a name is unique in
-- its map whatever became of the image. deleted_at_us is a tombstone: the vertex's number and the name stay taken.
CREATE TABLE images (
  id INTEGER PRIMARY KEY AUTOINCREMENT,
  map INTEGER NOT NULL REFERENCES maps (id) ON DELETE CASCADE,
  vertex INTEGER CHECK (vertex >= 0),
  name TEXT NOT NULL,
  sha256 BLOB NOT NULL CHECK (length(sha256) = 32),  -- of the bytes as uploaded
  media_type TEXT NOT NULL,
  width_px INTEGER NOT NULL,
  height_px INTEGER NOT NULL,
  features INTEGER NOT NULL,
  captured_at_us INTEGER,
  sequence TEXT,
  sequence_index INTEGER,
  camera TEXT CHECK (camera IS NULL OR json_valid(camera)),  -- model and intrinsics
  reason TEXT NOT NULL,   -- why it has no edge, '' when it has; ignored: ''
  similar_to INTEGER,     -- ignored: the vertex that it resembles too much
  inliers INTEGER,        -- ignored: to that vertex
  uploaded_at_us INTEGER NOT NULL,
  deleted_at_us INTEGER,
  CHECK ((vertex IS NULL) = (similar_to IS NOT NULL) AND (similar_to IS NULL) = (inliers IS NULL)),
  UNIQUE (map, name),
  UNIQUE (map, vertex)
) STRICT;
CREATE INDEX images_ignored ON images (map) WHERE vertex IS NULL;

-- The bytes of an image as they were uploaded; none when they were not kept or have been deleted.
CREATE TABLE image_bytes (
  image INTEGER PRIMARY KEY REFERENCES images (id) ON DELETE CASCADE,
  bytes BLOB NOT NULL
) STRICT;

-- The appearance vector of a vertex under a vocabulary; several while a map is indexed anew.
CREATE TABLE appearances (
  map INTEGER NOT NULL,
  vertex INTEGER NOT NULL,
  vocabulary INTEGER NOT NULL REFERENCES vocabularies (id),
  bytes BLOB NOT NULL,  -- schema/blobs/appearance_blob.h
  PRIMARY KEY (map, vertex, vocabulary),
  FOREIGN KEY (map, vertex) REFERENCES images (map, vertex) ON DELETE CASCADE
) STRICT;

-- The inverted index at rest: immutable segments over ranges of vertices, each cut into blocks of consecutive words.
CREATE TABLE segments (
  id INTEGER PRIMARY KEY AUTOINCREMENT,
  map INTEGER NOT NULL REFERENCES maps (id) ON DELETE CASCADE,
  vocabulary INTEGER NOT NULL REFERENCES vocabularies (id),
  first_vertex INTEGER NOT NULL,
  count INTEGER NOT NULL CHECK (count > 0),
  postings INTEGER NOT NULL,
  UNIQUE (map, vocabulary, first_vertex)
) STRICT;

CREATE TABLE posting_blocks (
  id INTEGER PRIMARY KEY,
  segment INTEGER NOT NULL REFERENCES segments (id) ON DELETE CASCADE,
  first_word INTEGER NOT NULL,
  bytes BLOB NOT NULL,  -- schema/blobs/posting_blob.h
  UNIQUE (segment, first_word)
) STRICT;

-- Which verifier, with which parameters, gave a verdict; verdicts of different ones are never mixed up.
CREATE TABLE verifiers (
  id INTEGER PRIMARY KEY AUTOINCREMENT,
  version TEXT NOT NULL,
  parameters TEXT NOT NULL CHECK (json_valid(parameters)),
  UNIQUE (version, parameters)
) STRICT;

-- Merge jobs. granted_* is what was spent when the budget was given: the budget is an allowance on top of it.
CREATE TABLE merges (
  id INTEGER PRIMARY KEY AUTOINCREMENT,
  map INTEGER NOT NULL UNIQUE REFERENCES maps (id) ON DELETE CASCADE,
  method TEXT NOT NULL,
  seed INTEGER NOT NULL,  -- 64 bits, unsigned
  parameters TEXT NOT NULL CHECK (json_valid(parameters)),
  budget TEXT NOT NULL CHECK (json_valid(budget)),
  granted_elapsed_s REAL NOT NULL DEFAULT 0,
  granted_verifications INTEGER NOT NULL DEFAULT 0,
  granted_edges INTEGER NOT NULL DEFAULT 0,
  state TEXT NOT NULL
    CHECK (state IN ('queued', 'running', 'paused', 'budget_exhausted', 'completed', 'cancelled', 'failed')),
  phase TEXT NOT NULL,
  stop_reason TEXT,
  error TEXT,
  epoch INTEGER NOT NULL DEFAULT 0,  -- fencing: a worker writes only under the epoch that it was given
  step INTEGER NOT NULL DEFAULT 0,   -- this and what follows: as of the last checkpoint
  elapsed_s REAL NOT NULL DEFAULT 0,
  verifications INTEGER NOT NULL DEFAULT 0,
  edges INTEGER NOT NULL DEFAULT 0,
  progress TEXT NOT NULL DEFAULT '{}' CHECK (json_valid(progress)),
  checkpoint_at_us INTEGER,
  created_at_us INTEGER NOT NULL,
  updated_at_us INTEGER NOT NULL
) STRICT;
CREATE INDEX merges_by_state ON merges (state);

-- The state of a job as named parts, each cut into chunks.
CREATE TABLE checkpoints (
  job INTEGER NOT NULL REFERENCES merges (id) ON DELETE CASCADE,
  part TEXT NOT NULL,
  chunk INTEGER NOT NULL,
  crc32 INTEGER NOT NULL,  -- of the bytes
  bytes BLOB NOT NULL,
  PRIMARY KEY (job, part, chunk)
) STRICT;

CREATE TABLE curve_points (
  job INTEGER NOT NULL REFERENCES merges (id) ON DELETE CASCADE,
  step INTEGER NOT NULL,
  elapsed_s REAL NOT NULL,
  verifications INTEGER NOT NULL,
  edges INTEGER NOT NULL,
  components INTEGER NOT NULL,
  algebraic_connectivity REAL NOT NULL,
  largest_vertices INTEGER NOT NULL,
  largest_algebraic_connectivity REAL NOT NULL,
  certified_fraction REAL,
  phase TEXT NOT NULL,
  PRIMARY KEY (job, step)
) STRICT, WITHOUT ROWID;

-- Inner edges of plain maps and inter edges of merged maps (job IS NOT NULL), ids in order of insertion. u < v, numbered as
-- `map` numbers its vertices.
CREATE TABLE edges (
  id INTEGER PRIMARY KEY AUTOINCREMENT,
  map INTEGER NOT NULL REFERENCES maps (id) ON DELETE CASCADE,
  u INTEGER NOT NULL CHECK (u >= 0),
  v INTEGER NOT NULL CHECK (v > u),
  votes INTEGER NOT NULL,
  matches INTEGER NOT NULL,             -- one-to-one word matches that were put to the verifier
  inliers INTEGER NOT NULL,
  log10_false_alarms REAL NOT NULL,
  evidence BLOB NOT NULL,               -- geometry and inlier matches: schema/blobs/evidence_blob.h
  verifier INTEGER NOT NULL REFERENCES verifiers (id),
  confirmed INTEGER NOT NULL CHECK (confirmed IN (0, 1)),
  doubt TEXT CHECK ((doubt IS NULL) = (confirmed = 1)),  -- why it is not confirmed: a reason of docs/http-api.md
  job INTEGER REFERENCES merges (id) ON DELETE CASCADE,
  verifications INTEGER,                -- inter: how the merge stood when this edge was inserted
  elapsed_s REAL,
  UNIQUE (map, u, v)
) STRICT;
CREATE INDEX edges_in_order ON edges (map);  -- then id, as every index
CREATE INDEX edges_by_later_end ON edges (map, v);
CREATE INDEX edges_by_job ON edges (job) WHERE job IS NOT NULL;

-- Facts about the database itself.
CREATE TABLE meta (
  key TEXT PRIMARY KEY,
  value TEXT NOT NULL
) STRICT, WITHOUT ROWID;

PRAGMA application_id = 0x4D574C44;
