-- What is thought of an edge beside what the verifier says, for inner and inter edges alike. NULL: not judged; such an edge
-- is confirmed.
ALTER TABLE edges ADD COLUMN confidence REAL CHECK (confidence BETWEEN 0 AND 1);
ALTER TABLE edges ADD COLUMN judgement BLOB;  -- what the confidence is made of: schema/blobs/judgement_blob.h

-- A guard that said yes or no was as sure as that.
UPDATE edges SET confidence = confirmed
  WHERE job IN (SELECT id FROM merges WHERE json_extract(parameters, '$.alias_guard')) OR confirmed = 0;

-- How many of a map's `edges` are not confirmed, and how often its edges were judged.
ALTER TABLE maps ADD COLUMN unconfirmed INTEGER NOT NULL DEFAULT 0;
ALTER TABLE maps ADD COLUMN judgements INTEGER NOT NULL DEFAULT 0;
UPDATE maps SET unconfirmed = (SELECT count(*) FROM edges WHERE edges.map = maps.id AND confirmed = 0);

-- Of the edges of a point; NULL where that was not written down.
ALTER TABLE curve_points ADD COLUMN confirmed INTEGER;
