#include "server/commands/backup.h"

#include <filesystem>
#include <functional>
#include <iostream>
#include <memory>
#include <string>

#include <CLI/CLI.hpp>

#include "schema/engine/data_folder.h"
#include "schema/store_check.h"

namespace mapweld::server {
namespace {

namespace fs = std::filesystem;

constexpr int kDamaged = 1;
constexpr int kFailed = 2;

DataFolderOptions inspect() {
  DataFolderOptions options;
  options.access = DataFolderOptions::Access::kInspect;
  return options;
}

int backup(const fs::path& data, const fs::path& target) {
  DataFolder folder(data, inspect());
  folder.store().backup(target);
  fs::permissions(target, fs::perms::owner_read | fs::perms::owner_write);
  std::cout << target.string() << ": " << fs::file_size(target) << " bytes" << std::endl;
  return 0;
}

int restore(const fs::path& backup, const fs::path& data) {
  restore_backup(backup, data);
  DataFolder folder(data, inspect());
  const StoreCheckReport report = check_store(folder.store().read());
  for (const Finding& finding : report.findings) std::cout << finding.where << ": " << finding.what << "\n";
  std::cout << data.string() << ": " << report.maps << " maps, " << report.images << " images, "
            << (report.findings.empty() ? "all in order" : "damaged") << std::endl;
  return report.findings.empty() ? 0 : kDamaged;
}

void run(const std::function<int()>& command) {
  int exit_code = 0;
  try {
    exit_code = command();
  } catch (const std::exception& error) {
    std::cerr << "mapweld-server: " << error.what() << std::endl;
    exit_code = kFailed;
  }
  if (exit_code != 0) throw CLI::RuntimeError(exit_code);
}

}  // namespace

void add_backup_commands(CLI::App& app) {
  const auto data = std::make_shared<std::string>();
  const auto file = std::make_shared<std::string>();
  CLI::App* save = app.add_subcommand("backup", "Copies a data folder into one file, also beside a running server");
  save->add_option("--data", *data, "Data folder")->envname("MAPWELD_DATA")->required();
  save->add_option("FILE", *file, "The file to make; it must not exist")->required();
  save->callback([data, file] { run([&] { return backup(*data, *file); }); });

  CLI::App* load = app.add_subcommand("restore", "Makes a data folder of a backup and proves that it is whole");
  load->add_option("--data", *data, "Data folder to make; it must have no database")
      ->envname("MAPWELD_DATA")
      ->required();
  load->add_option("FILE", *file, "The backup; it stays as it is")->required();
  load->callback([data, file] { run([&] { return restore(*file, *data); }); });
}

}  // namespace mapweld::server
