-- Vertices can be deleted. images.deleted_at_us is their tombstone; until they are restored or purged all the rest of them stays,
-- and their edges stand here instead of in `edges`, of which no reader has to ask whether its ends are there.
CREATE TABLE deleted_edges (
  id INTEGER PRIMARY KEY,  -- as in `edges`, and so is the rest
  map INTEGER NOT NULL REFERENCES maps (id) ON DELETE CASCADE,
  u INTEGER NOT NULL CHECK (u >= 0),
  v INTEGER NOT NULL CHECK (v > u),
  votes INTEGER NOT NULL,
  matches INTEGER NOT NULL,
  inliers INTEGER NOT NULL,
  log10_false_alarms REAL NOT NULL,
  evidence BLOB NOT NULL,
  verifier INTEGER NOT NULL REFERENCES verifiers (id),
  confirmed INTEGER NOT NULL CHECK (confirmed IN (0, 1)),
  doubt TEXT CHECK ((doubt IS NULL) = (confirmed = 1)),
  job INTEGER REFERENCES merges (id) ON DELETE CASCADE,
  verifications INTEGER,
  elapsed_s REAL,
  confidence REAL CHECK (confidence BETWEEN 0 AND 1),
  judgement BLOB,
  checksum INTEGER NOT NULL DEFAULT 0x7FFFFFFFFFFFFFFF,
  UNIQUE (map, u, v)
) STRICT;
CREATE INDEX deleted_edges_by_later_end ON deleted_edges (map, v);
CREATE INDEX deleted_edges_by_job ON deleted_edges (job) WHERE job IS NOT NULL;

CREATE INDEX images_deleted ON images (map, vertex) WHERE deleted_at_us IS NOT NULL;

-- The numbers of vertices that were deleted and have no row in `images` any more. They are not given again.
CREATE TABLE purged_vertices (
  map INTEGER NOT NULL REFERENCES maps (id) ON DELETE CASCADE,
  vertex INTEGER NOT NULL CHECK (vertex >= 0),
  checksum INTEGER NOT NULL DEFAULT 0x7FFFFFFFFFFFFFFF,
  PRIMARY KEY (map, vertex)
) STRICT, WITHOUT ROWID;
