#include "server/copies/map_transfer.h"

#include <algorithm>
#include <cctype>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <vector>

#include "client/contract/json.h"
#include "client/contract/names.h"
#include "client/contract/problem.h"
#include "core/errors.h"
#include "core/vocabulary/foreign_vocabulary.h"
#include "schema/maps/map_layout.h"
#include "schema/maps/vertex_store.h"
#include "schema/maps/vocabulary_store.h"
#include "server/http/files/body_file.h"
#include "server/maps/map_settings.h"
#include "server/services/map_lookup.h"
#include "server/services/quotas.h"
#include "server/services/uuid.h"

namespace mapweld::server {
namespace {

using contract::ContractError;

constexpr std::size_t kImagesAtOnce = 1000;

[[noreturn]] void refuse(const std::string& what) { throw ContractError("damaged_file", what); }

// What a server answers with as it is stored, and what only its own requests would have kept from being nonsense.
void check_image(const ImageRow& image, int max_features) {
  constexpr int kMaxSide = 8192;
  const bool known = image.media_type == "image/jpeg" || image.media_type == "image/png";
  const std::optional<std::string>& sequence = image.provenance.sequence;
  if (!known || !contract::is_image_name(image.name) || image.features > max_features ||
      (sequence && !contract::is_image_name(*sequence)) || image.width_px < 1 || image.height_px < 1 ||
      image.width_px > kMaxSide || image.height_px > kMaxSide) {
    refuse("The file has an image as no server stores it.");
  }
}

void check_content(MapFile& file) {
  const ReadTransaction db = file.store().read();
  const MapLayout layout = load_layout(db, file.map().id);
  const int max_features = settings_of(file.map()).parameters.max_features;
  std::optional<VertexId> vertex;
  while (true) {
    const std::vector<VertexRow> rows = list_vertices(db, layout, kImagesAtOnce, vertex);
    for (const VertexRow& row : rows) check_image(row.image, max_features);
    if (rows.size() < kImagesAtOnce) break;
    vertex = rows.back().vertex;
  }
  std::optional<ImageId> ignored;
  while (true) {
    const std::vector<ImageRow> rows = list_ignored(db, file.map().id, kImagesAtOnce, ignored);
    for (const ImageRow& row : rows) check_image(row, max_features);
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
    request.labels = contract::parse_json(map.labels).get<std::map<std::string, std::string>>();
    contract::check(request);
  } catch (const std::exception& error) {
    refuse(std::string("The map of the file is not one that a server has: ") + error.what());
  }
}

void require_free(const Reader& db, const std::string& name) {
  if (!find_map(db, name)) return;
  throw ContractError("name_taken", "There is a map named \"" + name + "\" already. Give another with ?name=.");
}

// A file's word numbers are good for a vocabulary of these words alone.
void require_same_words(const VocabularyRow& wanted, const VocabularyRow& here) {
  if (wanted.words != here.words || wanted.dimension != here.dimension) {
    refuse("The file says of its vocabulary what is not so.");
  }
}

// Runs what reads or copies a stranger's file.
template <typename Read>
auto from_file(Read&& read) {
  try {
    return read();
  } catch (const StoreError& error) {
    switch (error.kind()) {
      case StoreErrorKind::kForeignDatabase:
        refuse("The body is not a map that a server has exported.");
      case StoreErrorKind::kNewerVersion:
        refuse("The file is of a newer version of Mapweld than this server.");
      case StoreErrorKind::kCorrupt:
      case StoreErrorKind::kConstraint:
        refuse(error.what());
      default:
        throw;
    }
  }
}

}  // namespace

MapTransfer::MapTransfer(Store& store, MapService& maps, VocabularyService& vocabularies, std::filesystem::path folder)
    : store_(store), maps_(maps), vocabularies_(vocabularies), folder_(std::move(folder)), life_(make_uuid()) {}

MapTransfer::Exported MapTransfer::export_map(const std::string& name, const MapFileOptions& options) const {
  const ReadTransaction db = store_.read();
  const MapRow map =
      require_plain_map(db, name, "a view of its members: export them, and merge them where they arrive.");
  BodyFile place(folder_);  // a name that is nobody else's, and gone afterwards
  std::filesystem::remove(place.path());
  mapweld::export_map(db, map.id, place.path(), options);
  return {std::make_shared<const OpenFile>(place.path()), life_ + "-" + std::to_string(to_index(map.id)) + "-" +
                                                              std::to_string(map.revision) +
                                                              (options.pixels ? "" : "-words")};
}

contract::Map MapTransfer::import_map(const std::filesystem::path& path, const std::optional<std::string>& name,
                                      const Caller* caller, const Keep<contract::Map>& keep) {
  if (name) contract::check_slug(*name, "The map's name");
  const std::unique_lock proving(proving_, std::try_to_lock);
  if (!proving) throw ContractError("busy", "Another file is being taken in. Try again when it is.");
  const auto file = from_file([&] { return std::make_unique<MapFile>(path); });
  check_settings(file->map());
  from_file([&] { check_content(*file); });
  const std::string own_name = name.value_or(file->map().name);
  require_use(caller, own_name);
  require_free(store_.read(), own_name);
  const VocabularyId vocabulary = vocabulary_of(*file, caller);
  std::string uuid = file->map().uuid;
  std::ranges::transform(uuid, uuid.begin(), [](unsigned char c) { return std::tolower(c); });
  WriteTransaction db = store_.write();
  require_free(db, own_name);
  if (!contract::is_uuid(uuid) || find_map_by_uuid(db, uuid)) uuid = make_uuid();
  const MapId id = from_file([&] { return mapweld::import_map(db, *file, own_name, uuid, vocabulary); });
  if (caller != nullptr) {
    own_images_of(db, id, caller->id);
    require_images_fit(db, caller);
  }
  contract::Map imported = maps_.get(db, own_name);
  if (keep) keep(db, imported);
  db.commit();
  return imported;
}

VocabularyId MapTransfer::vocabulary_of(MapFile& file, const Caller* caller) {
  const VocabularyRow& wanted = file.vocabulary();
  const std::vector<VocabularyRow> rows = list_vocabularies(store_.read(), 1000);
  const auto known = std::ranges::find(rows, wanted.sha256, &VocabularyRow::sha256);
  if (known != rows.end()) {
    require_same_words(wanted, *known);
    return known->id;
  }
  if (std::ranges::find(rows, wanted.name, &VocabularyRow::name) != rows.end()) {
    throw ContractError(
        "vocabulary_mismatch",
        "The map's words are of another vocabulary than the one that is named \"" + wanted.name + "\" here.");
  }
  if (caller != nullptr && caller->role < Role::kAdmin) {
    throw ContractError("vocabulary_mismatch",
                        "The map's words are of the vocabulary \"" + wanted.name +
                            "\", which this server has not; a key of the role admin can bring it.");
  }
  const auto bytes = load_vocabulary_file(file.store().read(), wanted.id);
  try {
    VocabularyRow row;
    row.words = deserialize_foreign(bytes)->words();
    require_same_words(wanted, row);
  } catch (const FormatError& error) {
    refuse(error.what());
  }
  vocabularies_.add(wanted.name, bytes);
  return find_vocabulary(store_.read(), wanted.name).value().id;
}

}  // namespace mapweld::server
