-- Answers to requests that came with an Idempotency-Key, for those who ask again. `map`: the one that an answer tells
-- of. No reference: an answer outlives its map, until that is purged.
CREATE TABLE kept_answers (
  caller INTEGER NOT NULL,  -- the id of the caller's key; 0: nobody was asked who they are
  key TEXT NOT NULL,
  part INTEGER NOT NULL CHECK (part >= 0),  -- of a batch; 0 of what has no parts
  request BLOB NOT NULL CHECK (length(request) = 32),
  status INTEGER NOT NULL,
  headers TEXT NOT NULL,  -- "name: value" lines
  body TEXT NOT NULL,
  map INTEGER,
  kept_at_us INTEGER NOT NULL,
  checksum INTEGER NOT NULL DEFAULT 0x7FFFFFFFFFFFFFFF,
  PRIMARY KEY (caller, key, part)
) STRICT;
CREATE INDEX kept_answers_by_age ON kept_answers (kept_at_us);
