#include "server/commands/purge.h"

#include <filesystem>
#include <iostream>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "schema/answer_store.h"
#include "schema/engine/data_folder.h"
#include "schema/maps/map_store.h"
#include "schema/maps/purge.h"

namespace mapweld::server {
namespace {

namespace fs = std::filesystem;

constexpr int kFailed = 2;

// The plain maps that are to be purged: one by its name, or all.
std::vector<MapRow> maps_to_purge(const Reader& db, const std::string& name) {
  if (name.empty()) {
    std::vector<MapRow> maps = list_maps(db, SIZE_MAX >> 1);
    std::erase_if(maps, [](const MapRow& map) { return map.kind != MapKind::kMap; });
    return maps;
  }
  const std::optional<MapRow> map = find_map(db, name);
  if (!map) throw std::runtime_error("there is no map named \"" + name + "\"");
  if (map->kind != MapKind::kMap) {
    throw std::runtime_error("\"" + name + "\" is a merged map; its images are those of its members");
  }
  return {*map};
}

void purge(const fs::path& data, const std::string& name) {
  if (!fs::exists(data)) throw std::runtime_error("there is no data folder " + data.string());
  DataFolder folder(data);
  Store& store = folder.store();
  for (const MapRow& map : maps_to_purge(store.read(), name)) {
    PurgeStatistics purged;
    {
      WriteTransaction db = store.write(Store::Purpose::kDelete);
      purged = purge_deleted(db, map.id);
      db.commit();
    }
    if (purged.vertices == 0) continue;
    std::cout << map.name << ": " << purged.vertices << " images and " << purged.edges << " edges are gone, "
              << purged.segments << " segments and the state of " << purged.merges << " merges are written anew"
              << std::endl;
  }
  if (name.empty()) {
    WriteTransaction db = store.write(Store::Purpose::kDelete);
    drop_answers_of_deleted_maps(db);
    db.commit();
  }
  rewrite_database(store.file());
  fs::remove_all(data / "transit");  // copies of maps on their way, of a server that was killed
  std::cout << store.file().string() << ": " << fs::file_size(store.file()) << " bytes, nothing deleted among them"
            << std::endl;
}

}  // namespace

void add_purge_command(CLI::App& app) {
  const auto data = std::make_shared<std::string>();
  const auto map = std::make_shared<std::string>();
  CLI::App* command = app.add_subcommand(
      "purge", "Removes deleted images for good and leaves nothing of them in the files; with the server stopped");
  command->add_option("--data", *data, "Data folder")->envname("MAPWELD_DATA")->required();
  command->add_option("--map", *map, "Only this map's (default: all maps')");
  command->callback([data, map] {
    try {
      purge(*data, *map);
    } catch (const std::exception& error) {
      std::cerr << "mapweld-server: " << error.what() << std::endl;
      throw CLI::RuntimeError(kFailed);
    }
  });
}

}  // namespace mapweld::server
