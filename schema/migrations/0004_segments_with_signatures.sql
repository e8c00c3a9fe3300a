-- Segments hold the signatures that votes go by (schema/blobs/posting_blob.h). Those of before have none: they are
-- dropped, and written again from the appearances in the background.
DELETE FROM posting_blocks;
DELETE FROM segments;
