// A plain map as one file: a Mapweld database of its own, of the schema of this program, that holds the map and what it
// rests on. `mapweld-server restore` makes a server of it; import_map puts it among others.
//
// In the file: the map with its labels, parameters, mask and camera, its images (with their poses, and their pixels,
// where they are kept), their appearances word for word, its edges with all evidence in order of insertion, their
// verifiers, and the vocabulary that the words are of. Not in it: the inverted index, which is written anew from the
// appearances, merges, and images that were deleted, whose numbers are as those of purged ones.
#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "schema/maps/map_store.h"
#include "schema/maps/vocabulary_store.h"
#include "schema/store.h"
#include "schema/store_types.h"

namespace mapweld {

struct MapFileOptions {
  bool pixels = true;  // the images as they were uploaded, where they are kept
};

// Writes a plain map into `file`, which must not exist; what was written is removed again when this throws
// (StoreError). The same map in the same state gives the same bytes.
void export_map(const Reader& db, MapId map, const std::filesystem::path& file, const MapFileOptions& options = {});

// A file that claims to hold a map. What strangers send is believed in nothing: the file must be a Mapweld database,
// have the tables of its version to the letter, exactly one map without merges and index, and pass check_store.
class MapFile {
 public:
  // Brings a file of an older schema up to date: `file` is changed. Throws StoreError: kForeignDatabase, kNewerVersion,
  // kCorrupt with what is wrong.
  explicit MapFile(const std::filesystem::path& file);

  const MapRow& map() const { return map_; }
  const VocabularyRow& vocabulary() const { return vocabulary_; }
  // To read it as any store is read.
  Store& store() { return *store_; }

 private:
  std::unique_ptr<Store> store_;
  MapRow map_;
  VocabularyRow vocabulary_;
};

// Puts the map of a file among those of `db`, under another name and uuid, both of which must be free, and with a
// vocabulary that has the words of the file's. Numbers of vertices and the order of edges stay.
MapId import_map(WriteTransaction& db, MapFile& file, const std::string& name, const std::string& uuid,
                 VocabularyId vocabulary);

}  // namespace mapweld
