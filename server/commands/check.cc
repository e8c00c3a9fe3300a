#include "server/commands/check.h"

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <iostream>
#include <memory>
#include <utility>

#include <CLI/CLI.hpp>

#include "core/geometry/epipolar_verifier.h"
#include "schema/engine/data_folder.h"
#include "schema/key_store.h"
#include "schema/merges/merge_store.h"
#include "schema/store_check.h"
#include "server/jobs/merge_check.h"

namespace mapweld::server {
namespace {

constexpr int kDamaged = 1;
constexpr int kUnreadable = 2;

// Adds what keeps merges from going on, where the store's own check has nothing against their state. Prints notes.
void check_merges(const Reader& db, const StoreCheckOptions& options, StoreCheckReport& report) {
  options.on_progress("that merges can go on");
  for (const MergeRow& merge : list_merges(db, SIZE_MAX >> 1)) {
    if (report.findings.size() >= options.max_findings) return;
    const std::string where = where_of_checkpoint(merge.id);
    if (std::ranges::find(report.findings, where, &Finding::where) != report.findings.end()) continue;
    const MergeCheck check = check_merge(db, merge, make_verifier);
    for (const std::string& note : check.notes) std::cout << "note: " << where << ": " << note << "\n";
    for (const std::string& what : check.findings) report.findings.push_back({where, what});
  }
}

// True when everything is in order.
bool check(const std::filesystem::path& data, std::size_t max_findings, bool is_shallow) {
  DataFolderOptions inspect;
  inspect.access = DataFolderOptions::Access::kInspect;
  DataFolder folder(data, inspect);
  const ReadTransaction db = folder.store().read();
  StoreCheckOptions options;
  options.max_findings = max_findings;
  options.on_progress = [](std::string_view part) { std::cerr << "checking " << part << std::endl; };
  StoreCheckReport report = check_store(db, options);
  check_keys(data, [&](Finding finding) {
    if (report.findings.size() < max_findings) report.findings.push_back(std::move(finding));
  });
  if (!is_shallow) check_merges(db, options, report);
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
  const auto is_shallow = std::make_shared<bool>(false);
  CLI::App* command = app.add_subcommand("check", "Proves that a data folder is whole; also beside a running server");
  command->add_option("--data", *data, "Data folder")->envname("MAPWELD_DATA")->required();
  command->add_option("--max-findings", *max_findings, "Stop looking after so many")->capture_default_str();
  command->add_flag("--shallow", *is_shallow,
                    "Do not take merges up as a resume would, which costs the time and the memory of beginning each");
  command->callback([data, max_findings, is_shallow] {
    bool in_order = false;
    try {
      in_order = check(*data, *max_findings, *is_shallow);
    } catch (const std::exception& error) {
      std::cerr << "mapweld-server: " << error.what() << std::endl;
      throw CLI::RuntimeError(kUnreadable);
    }
    if (!in_order) throw CLI::RuntimeError(kDamaged);
  });
}

}  // namespace mapweld::server
