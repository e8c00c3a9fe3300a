// What the alias guard confirms, with the truth beside: the tables of docs/alias-guard.md.
//
//   guard_figures --cache FOLDER      the real places of MAPWELD_PHOTOS; merges are kept in FOLDER
//   ... --cases museum-region twin-2a-twin-3a                some of them
//   ... --rendered --scenarios ordinary laps --seeds 301 302
//   ... --uploaded shuffled:1   the photographs of each map in another order
//   ... --each          a line for each case, not only for each group of them
//   ... --list          every confirmed edge that is known to be wrong
//   ... --sample 60     confirmed edges at random, to be looked at
//   ... --prefixes 64   while the merge goes on: in the order of `spectral`, or --order random
//   ... --reliability FILE.svg   confidence against the share that is right
#include <algorithm>
#include <cstdio>
#include <fstream>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "tests/evaluation/guard/case_options.h"
#include "tests/evaluation/guard/guard_tables.h"
#include "tests/evaluation/guard/merge_order.h"
#include "tests/evaluation/guard/reliability.h"
#include "tests/evaluation/tool_main.h"

namespace mapweld::evaluation {
namespace {

struct Asked : CaseOptions {
  bool rendered = false, each = false, list = false, only_cached = false, compare = true;
  std::size_t sample = 0, prefixes = 0;
  std::string uploaded = "given", order = "spectral", reliability;
  std::uint64_t order_seed = 1;
  GuardOptions guard;
};

void figures(const Asked& asked, const std::vector<GuardCase>& cases) {
  Reliability reliability;
  std::string group;
  std::optional<GuardCounts> sum;
  std::size_t in_sum = 0;
  const auto end_group = [&] {
    if (sum && (in_sum > 1 || !asked.each)) print_counts(in_sum > 1 ? group + ", all" : group, *sum);
    sum.reset();
    in_sum = 0;
  };
  print_counts_head();
  for (const GuardCase& c : cases) {
    if (c.group != group) end_group();
    group = c.group;
    const JudgedMerge judged = judged_merge(c, asked.cache, asked.threads);
    const GuardRun run = run_guard(judged, asked.guard);
    if (asked.each) print_counts(c.name, run.counts);
    if (asked.list) print_wrong_confirmed(judged, run);
    if (asked.sample > 0) print_sample(judged, run, asked.sample, asked.order_seed);
    // Along one corridor of the twin storeys nobody knows how far one sees; elsewhere every edge that was looked at is
    // right.
    reliability.add(judged, run.inter, !c.name.starts_with("twin"));
    sum = sum.value_or(GuardCounts());
    *sum += run.counts;
    ++in_sum;
  }
  end_group();
  if (asked.reliability.empty()) return;
  std::printf("\n%s", reliability_table(reliability).c_str());
  std::ofstream(asked.reliability) << reliability_svg(reliability, std::to_string(cases.size()) + " merges");
}

void prefixes(const Asked& asked, const std::vector<GuardCase>& cases) {
  print_prefixes_head();
  for (const GuardCase& c : cases) {
    const JudgedMerge judged = judged_merge(c, asked.cache, asked.threads);
    if (judged.merge.inter_edges.empty()) continue;
    const auto edges = asked.order == "random" ? edges_at_random(judged, asked.order_seed) : edges_as_found(judged);
    print_prefixes(c.name, guard_prefixes(judged, edges, asked.prefixes, asked.guard, asked.compare));
  }
}

int run(int argc, char** argv) {
  CLI::App app{"What the alias guard confirms, with the truth beside.", "guard_figures"};
  Asked asked;
  asked.add_to(app);
  app.add_flag("--rendered", asked.rendered, "rendered scenarios instead of photographs");
  app.add_option("--uploaded", asked.uploaded, "photographs: given, reversed or shuffled:SEED");
  app.add_flag("--each", asked.each, "a line for each case as well");
  app.add_flag("--list", asked.list, "every confirmed edge that is known to be wrong");
  app.add_option("--sample", asked.sample, "so many confirmed edges of each case");
  app.add_option("--prefixes", asked.prefixes, "so many prefixes of the verified edges");
  app.add_option("--order", asked.order, "in which they come")->check(CLI::IsMember({"spectral", "random"}));
  app.add_option("--order-seed", asked.order_seed, "of --order random and of --sample");
  app.add_flag("!--no-fresh", asked.compare, "does not compare with a fresh guard at each prefix");
  app.add_option("--reliability", asked.reliability, "an SVG to write")
      ->check(CLI::NonexistentPath | CLI::ExistingFile);
  app.add_option("--min-confidence", asked.guard.min_confidence, "of a confirmed edge")->check(CLI::Range(0.0, 1.0));
  app.add_flag("--only-cached", asked.only_cached, "leaves out what is not in the cache yet");
  CLI11_PARSE(app, argc, argv);
  if (asked.rendered == asked.seeds.empty()) throw std::invalid_argument("--rendered and --seeds go together");
  auto cases = asked.cases();
  if (asked.uploaded != "given") {
    if (asked.rendered) throw std::invalid_argument("--uploaded is for photographs");
    const UploadOrder order = upload_order_of(asked.uploaded);
    for (GuardCase& c : cases) c = in_order(c, order);
  }
  if (asked.only_cached) std::erase_if(cases, [&](const GuardCase& c) { return !is_cached(c, asked.cache); });
  asked.prefixes > 0 ? prefixes(asked, cases) : figures(asked, cases);
  return 0;
}

}  // namespace
}  // namespace mapweld::evaluation

int main(int argc, char** argv) {
  return mapweld::evaluation::tool_main("guard_figures", mapweld::evaluation::run, argc, argv);
}
