-- The camera that took a map's images, where they name none of their own (images.camera); a map without a row says
-- nothing of it. JSON as the contract has it.
CREATE TABLE map_cameras (
  map INTEGER PRIMARY KEY REFERENCES maps (id) ON DELETE CASCADE,
  camera TEXT NOT NULL CHECK (json_valid(camera) AND length(camera) <= 4096),
  checksum INTEGER NOT NULL DEFAULT 0x7FFFFFFFFFFFFFFF
) STRICT;

-- Where images were taken, as their robots told; JSON as the contract has it. An image without a row says nothing.
CREATE TABLE image_poses (
  image INTEGER PRIMARY KEY REFERENCES images (id) ON DELETE CASCADE,
  pose TEXT NOT NULL CHECK (json_valid(pose) AND length(pose) <= 4096),
  checksum INTEGER NOT NULL DEFAULT 0x7FFFFFFFFFFFFFFF
) STRICT;
