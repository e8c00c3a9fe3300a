-- Which pixels of a map's images bear features; a map without a row has no mask. Applies to images that come after.
CREATE TABLE map_masks (
  map INTEGER PRIMARY KEY REFERENCES maps (id) ON DELETE CASCADE,
  sha256 BLOB NOT NULL CHECK (length(sha256) = 32),  -- of the bytes
  width_px INTEGER NOT NULL CHECK (width_px > 0),    -- as it is seen
  height_px INTEGER NOT NULL CHECK (height_px > 0),
  used_pixels INTEGER NOT NULL CHECK (used_pixels BETWEEN 1 AND width_px * height_px),
  set_at_us INTEGER NOT NULL,
  bytes BLOB NOT NULL                                -- the PNG as it was sent
) STRICT;

-- An image with the bytes of another is ignored. Its row has the reason 'identical', and as inliers all the features that
-- both have; one that is ignored as too similar has the reason ''.
CREATE INDEX images_by_content ON images (map, sha256);
