#include "server/commands/check.h"

#include <filesystem>
#include <iostream>
#include <memory>

#include <CLI/CLI.hpp>

#include "schema/data_folder.h"
#include "schema/store_check.h"

namespace mapweld::server {
namespace {

constexpr int kDamaged = 1;
constexpr int kUnreadable = 2;

// True when everything is in order.
bool check(const std::filesystem::path& data, std::size_t max_findings) {
  DataFolderOptions inspect;
  inspect.access = DataFolderOptions::Access::kInspect;
  DataFolder folder(data, inspect);
  const ReadTransaction db = folder.store().read();
  StoreCheckOptions options;
  options.max_findings = max_findings;
  options.on_progress = [](std::string_view part) { std::cerr << "checking " << part << std::endl; };
  const StoreCheckReport report = check_store(db, options);
  for (const Finding& finding : report.findings) std::cout << finding.where << ": " << finding.what << "\n";
  std::cout << report.maps << " maps, " << report.images << " images, " << report.appearances << " appearance vectors, "
            << report.segments << " segments, " << report.edges << " edges, " << report.checkpoints
            << " checkpoint parts: "
            << (report.findings.empty() ? "all in order" : std::to_string(report.findings.size()) + " findings")
            << std::endl;
  return report.findings.empty();
}

}  // namespace

void add_check_command(CLI::App& app) {
  const auto data = std::make_shared<std::string>();
  const auto max_findings = std::make_shared<std::size_t>(100);
  CLI::App* command = app.add_subcommand("check", "Proves that a data folder is whole; also beside a running server");
  command->add_option("--data", *data, "Data folder")->envname("MAPWELD_DATA")->required();
  command->add_option("--max-findings", *max_findings, "Stop looking after so many")->capture_default_str();
  command->callback([data, max_findings] {
    bool in_order = false;
    try {
      in_order = check(*data, *max_findings);
    } catch (const std::exception& error) {
      std::cerr << "mapweld-server: " << error.what() << std::endl;
      throw CLI::RuntimeError(kUnreadable);
    }
    if (!in_order) throw CLI::RuntimeError(kDamaged);
  });
}

}  // namespace mapweld::server
