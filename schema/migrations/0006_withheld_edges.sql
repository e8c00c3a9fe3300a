-- Edges that are not confirmed are few: lists of them, and degrees, which leave them out, need not read the others.
CREATE INDEX edges_withheld ON edges (map) WHERE confirmed = 0;  -- then id, as every index
CREATE INDEX edges_withheld_by_earlier_end ON edges (map, u, v) WHERE confirmed = 0;
CREATE INDEX edges_withheld_by_later_end ON edges (map, v) WHERE confirmed = 0;
