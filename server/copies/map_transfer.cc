#include "server/copies/map_transfer.h"

#include <algorithm>
#include <memory>
#include <vector>

#include "client/contract/names.h"
#include "client/contract/problem.h"
#include "schema/map_layout.h"
#include "schema/vertex_store.h"
#include "schema/vocabulary_store.h"
#include "server/http/files/body_file.h"
#include "server/maps/map_settings.h"
#include "server/services/map_lookup.h"
#include "server/services/uuid.h"

namespace mapweld::server {
namespace {

using contract::ContractError;

constexpr std::size_t kImagesAtOnce = 1000;

[[noreturn]] void refuse(const std::string& what) { throw ContractError("damaged_file", what); }

// What a server answers with as it is stored, and what only its own requests would have kept from being nonsense.
void check_image(const ImageRow& image) {
  constexpr int kMaxSide = 8192;
  const bool known = image.media_type == "image/jpeg" || image.media_type == "image/png";
  if (!known || !contract::is_image_name(image.name) || image.width_px < 1 || image.height_px < 1 ||
      image.width_px > kMaxSide || image.height_px > kMaxSide) {
    refuse("The file has an image as no server stores it.");
  }
}

void check_content(MapFile& file) {
  const ReadTransaction db = file.store().read();
  const MapLayout layout = load_layout(db, file.map().id);
  std::optional<VertexId> vertex;
  while (true) {
    const std::vector<VertexRow> rows = list_vertices(db, layout, kImagesAtOnce, vertex);
    for (const VertexRow& row : rows) check_image(row.image);
    if (rows.size() < kImagesAtOnce) break;
    vertex = rows.back().vertex;
  }
  std::optional<ImageId> ignored;
  while (true) {
    const std::vector<ImageRow> rows = list_ignored(db, file.map().id, kImagesAtOnce, ignored);
    for (const ImageRow& row : rows) check_image(row);
    if (rows.size() < kImagesAtOnce) break;
    ignored = rows.back().id;
  }
}

// The map as a request would have made it.
void check_settings(const MapRow& map) {
  try {
    contract::CreateMap request;
    request.name = map.name;
    request.parameters = describe(settings_of(map));
    request.labels = labels_of(map);
    contract::check(request);
  } catch (const std::exception& error) {
    refuse(std::string("The map of the file is not one that a server has: ") + error.what());
  }
}

std::unique_ptr<MapFile> open_map_file(const std::filesystem::path& path) {
  try {
    return std::make_unique<MapFile>(path);
  } catch (const StoreError& error) {
    switch (error.kind()) {
      case StoreErrorKind::kForeignDatabase:
        refuse("The body is not a map that a server has exported.");
      case StoreErrorKind::kNewerVersion:
        refuse("The file is of a newer version of Mapweld than this server.");
      case StoreErrorKind::kCorrupt:
        refuse(error.what());
      default:
        throw;
    }
  }
}

}  // namespace

MapTransfer::Exported MapTransfer::export_map(const std::string& name, const MapFileOptions& options) const {
  const ReadTransaction db = store_.read();
  const MapRow map = require_map(db, name);
  if (map.kind == MapKind::kMerged) {
    throw ContractError("map_is_merged", "A merged map is a view of its members: export them, and merge them there.");
  }
  BodyFile place(folder_);  // a name that is nobody else's, and gone afterwards
  std::filesystem::remove(place.path());
  mapweld::export_map(db, map.id, place.path(), options);
  return {std::make_shared<const OpenFile>(place.path()),
          map.uuid + "-" + std::to_string(map.revision) + (options.pixels ? "" : "-words")};
}

contract::Map MapTransfer::import_map(const std::filesystem::path& path, const std::optional<std::string>& name,
                                      const Caller* caller) {
  if (name) contract::check_slug(*name, "The map's name");
  const std::lock_guard proving(proving_);
  const std::unique_ptr<MapFile> file = open_map_file(path);
  check_settings(file->map());
  check_content(*file);
  const std::string own_name = name.value_or(file->map().name);
  require_use(caller, own_name);
  const VocabularyId vocabulary = vocabulary_of(*file, caller);
  WriteTransaction db = store_.write();
  if (find_map(db, own_name)) {
    throw ContractError("name_taken", "There is a map named \"" + own_name + "\" already. Give another with ?name=.");
  }
  const bool uuid_is_free = contract::is_uuid(file->map().uuid) && !find_map_by_uuid(db, file->map().uuid);
  mapweld::import_map(db, *file, own_name, uuid_is_free ? file->map().uuid : make_uuid(), vocabulary);
  db.commit();
  return maps_.get(own_name);
}

VocabularyId MapTransfer::vocabulary_of(MapFile& file, const Caller* caller) {
  const VocabularyRow& wanted = file.vocabulary();
  const std::vector<VocabularyRow> rows = list_vocabularies(store_.read(), 1000);
  const auto known = std::ranges::find(rows, wanted.sha256, &VocabularyRow::sha256);
  if (known != rows.end()) return known->id;
  if (std::ranges::find(rows, wanted.name, &VocabularyRow::name) != rows.end()) {
    throw ContractError("vocabulary_mismatch", "The map's words are of another vocabulary than the one that is named \"" +
                                                   wanted.name + "\" here.");
  }
  if (caller != nullptr && caller->role < Role::kAdmin) {
    throw ContractError("vocabulary_mismatch", "The map's words are of the vocabulary \"" + wanted.name +
                                                   "\", which this server has not; a key of the role admin can bring it.");
  }
  vocabularies_.add(wanted.name, load_vocabulary_file(file.store().read(), wanted.id));
  return find_vocabulary(store_.read(), wanted.name).value().id;
}

}  // namespace mapweld::server
