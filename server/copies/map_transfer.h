// Maps that go from one server to another as files (schema/maps/map_file.h).
#pragma once

#include <filesystem>
#include <memory>
#include <mutex>
#include <optional>
#include <string>

#include "client/contract/map.h"
#include "schema/maps/map_file.h"
#include "schema/store.h"
#include "server/access/caller.h"
#include "server/http/files/file_reply.h"
#include "server/services/map_service.h"
#include "server/services/vocabulary_service.h"

namespace mapweld::server {

// Thread-safe. Throws ContractError and StoreError; then nothing has changed.
class MapTransfer {
 public:
  // `folder` is there, for files that have no name any more when a function returns. All must outlive this.
  MapTransfer(Store& store, MapService& maps, VocabularyService& vocabularies, std::filesystem::path folder);

  struct Exported {
    std::shared_ptr<const OpenFile> file;
    std::string state;  // which state of the map it is, in this life of the server
  };
  // no_such_map, map_is_merged.
  Exported export_map(const std::string& name, const MapFileOptions& options) const;

  // Takes in a file that export_map wrote, here or elsewhere, as the map `name`, or under the name that it has. It
  // keeps its uuid, unless that is taken here. A vocabulary that this server has not comes with it, if the caller may
  // add one. `file` is changed. damaged_file, invalid_name, name_taken, vocabulary_mismatch, forbidden, quota_exceeded;
  // busy while another file is taken in.
  contract::Map import_map(const std::filesystem::path& file, const std::optional<std::string>& name,
                           const Caller* caller, const Keep<contract::Map>& keep = {});

 private:
  VocabularyId vocabulary_of(MapFile& file, const Caller* caller);

  Store& store_;
  MapService& maps_;
  VocabularyService& vocabularies_;
  const std::filesystem::path folder_;
  const std::string life_;
  std::mutex proving_;  // files are proved one at a time: that reads all of them
};

}  // namespace mapweld::server
