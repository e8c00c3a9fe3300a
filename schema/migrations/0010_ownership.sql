-- What each API key has brought: rows for what came with a key, none for the rest. Deleting gives back, however it comes
-- about; so triggers see to it. Keys stand in another database: no references.
CREATE TABLE owned_images (
  image INTEGER PRIMARY KEY REFERENCES images (id) ON DELETE CASCADE,
  key INTEGER NOT NULL,
  bytes INTEGER NOT NULL CHECK (bytes >= 0),  -- that are kept of it
  checksum INTEGER NOT NULL DEFAULT 0x7FFFFFFFFFFFFFFF
) STRICT;

CREATE TABLE owned_merges (
  merge INTEGER PRIMARY KEY REFERENCES merges (id) ON DELETE CASCADE,
  key INTEGER NOT NULL,  -- who let it run last
  checksum INTEGER NOT NULL DEFAULT 0x7FFFFFFFFFFFFFFF
) STRICT;
CREATE INDEX owned_merges_by_key ON owned_merges (key);

-- Sums over owned_images.
CREATE TABLE key_usage (
  key INTEGER PRIMARY KEY,
  images INTEGER NOT NULL CHECK (images >= 0),
  bytes INTEGER NOT NULL CHECK (bytes >= 0),
  checksum INTEGER NOT NULL DEFAULT 0x7FFFFFFFFFFFFFFF
) STRICT;

CREATE TRIGGER owned_image_comes AFTER INSERT ON owned_images BEGIN
  INSERT INTO key_usage (key, images, bytes) VALUES (NEW.key, 0, 0) ON CONFLICT (key) DO NOTHING;
  UPDATE key_usage SET images = images + 1, bytes = bytes + NEW.bytes WHERE key = NEW.key;
END;
CREATE TRIGGER owned_image_shrinks AFTER UPDATE OF bytes ON owned_images BEGIN
  UPDATE key_usage SET bytes = bytes - OLD.bytes + NEW.bytes WHERE key = NEW.key;
END;
CREATE TRIGGER owned_image_goes AFTER DELETE ON owned_images BEGIN
  UPDATE key_usage SET images = images - 1, bytes = bytes - OLD.bytes WHERE key = OLD.key;
END;
CREATE TRIGGER image_bytes_go AFTER DELETE ON image_bytes BEGIN
  UPDATE owned_images SET bytes = 0 WHERE image = OLD.image;
END;
CREATE TRIGGER image_is_deleted AFTER UPDATE OF deleted_at_us ON images WHEN NEW.deleted_at_us IS NOT NULL BEGIN
  DELETE FROM owned_images WHERE image = NEW.id;
END;
