-- How many of an image's features its map took for static when it was inserted: they neither vote nor match. They stand
-- with its appearances, in a blob of version 3 (schema/blobs/appearance_blob.h).
ALTER TABLE images ADD COLUMN static_features INTEGER NOT NULL DEFAULT 0
  CHECK (static_features BETWEEN 0 AND features);
