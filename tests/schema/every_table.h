// A store with something in every table.
#pragma once

#include "tests/support/temp_store.h"

namespace mapweld::test {

// Fills an empty store: two maps, `a` and `b`, of 20 vertices with bytes, appearances and edges, segments written; `a`
// has an ignored image and a mask; `ab` merges them, with a checkpoint, an inter edge and a point of the curve. Then
// `b` got two more, of which one is purged, and the other, with an edge, deleted.
struct EveryTable {
  explicit EveryTable(Store& store);
  VocabularyId vocabulary;
  MapId a;
  MapId b;
};

}  // namespace mapweld::test
