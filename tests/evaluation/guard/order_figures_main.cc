// How many verifications each order needs beside the clairvoyant, who knows which candidates pass: the tables of
// docs/spectral.md. On the confirmed graph, from the maps and verdicts that guard_figures keeps in its folder.
//
//   order_figures --cache FOLDER                                     the real places
//   order_figures --cache FOLDER --scenarios laps --seeds 311 312    rendered ones
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>

#include "core/guard/alias_guard.h"
#include "server/evaluation/curves.h"
#include "server/evaluation/limit.h"
#include "server/evaluation/recorded_run.h"
#include "tests/evaluation/guard/case_options.h"
#include "tests/evaluation/guard/judged_merge.h"
#include "tests/evaluation/guard/merge_order.h"
#include "tests/evaluation/tool_main.h"

namespace mapweld::evaluation {
namespace {

using server::evaluation::FinalComponent;
using server::evaluation::RecordedEdge;
using server::evaluation::RecordedRun;
using server::evaluation::RunCurve;

const std::vector<double> kLevels{0.9, 0.95, 0.99};

// By level: of all cases, in their order.
using Ratios = std::vector<std::vector<double>>;

RecordedRun confirmed_run(MergeInput input, const std::string& method,
                          const std::set<std::pair<VertexId, VertexId>>& confirmed) {
  input.options.method = method;
  RecordedRun run = server::evaluation::record_run(std::move(input));
  std::erase_if(run.edges, [&](const RecordedEdge& e) { return !confirmed.contains({e.u, e.v}); });
  return run;
}

void figures(const std::string& name, const JudgedMerge& judged, const std::vector<std::string>& methods,
             std::vector<Ratios>& ratios) {
  const AppearanceTable appearances = judged.merge.appearances();
  AliasGuard guard(judged.merge.members(), judged.inner, appearances);
  std::set<std::pair<VertexId, VertexId>> confirmed;
  const std::vector<GuardVerdict>& verdicts = guard.verdicts(judged.merge.inter_edges);
  for (std::size_t e = 0; e < verdicts.size(); ++e) {
    const MergeEdge& edge = judged.merge.inter_edges[e];
    if (verdicts[e].confirmed()) confirmed.insert(std::minmax(edge.u, edge.v));
  }
  const MergeInput input = known_merge(judged, confirmed_edges(judged.inner, guard.inner_verdicts()));
  std::vector<RecordedRun> runs;
  for (const std::string& method : methods) runs.push_back(confirmed_run(input, method, confirmed));
  const FinalComponent component(input, runs.front().edges);
  if (runs.front().edges.empty() || component.final_connectivity() <= 0) return;
  const auto limit = server::evaluation::limit_of(component, runs.front().edges, {.levels = kLevels});

  std::printf("| %s | %llu | %zu |", name.c_str(), static_cast<unsigned long long>(runs.front().cost.verifications),
              confirmed.size());
  for (std::size_t l = 0; l < kLevels.size(); ++l) {
    std::printf("%s %llu", l > 0 ? " /" : "", static_cast<unsigned long long>(limit.levels[l].clairvoyant->edges));
  }
  std::printf(" |");
  for (std::size_t m = 0; m < runs.size(); ++m) {
    RunCurve curve(component, runs[m]);
    std::string spent, times;
    for (std::size_t l = 0; l < kLevels.size(); ++l) {
      const std::uint64_t verifications = cost_of(runs[m], *curve.edges_to(kLevels[l])).verifications;
      const double ratio = static_cast<double>(verifications) /
                           static_cast<double>(std::max<std::uint64_t>(1, limit.levels[l].clairvoyant->edges));
      ratios[m][l].push_back(ratio);
      char text[32];
      std::snprintf(text, sizeof text, "%s%.1f", l > 0 ? " / " : "", ratio);
      times += text;
      spent += (l > 0 ? " / " : "") + std::to_string(verifications);
    }
    std::printf(" %s | %s |", spent.c_str(), times.c_str());
  }
  std::printf("\n");
  std::fflush(stdout);
}

int run_tool(int argc, char** argv) {
  CLI::App app{"How many verifications each order needs beside the clairvoyant.", "order_figures"};
  CaseOptions options;
  std::vector<std::string> methods{"spectral", "quickconnect"};
  options.add_to(app);
  app.add_option("--methods", methods, "the orders");
  CLI11_PARSE(app, argc, argv);
  std::printf("| case | candidates | confirmed | clairvoyant, 90 / 95 / 99 %% |");
  for (const std::string& method : methods) std::printf(" %s | times |", method.c_str());
  std::printf("\n|---|---|---|---|");
  for (std::size_t m = 0; m < methods.size(); ++m) std::printf("---|---|");
  std::printf("\n");
  std::vector<Ratios> ratios(methods.size(), Ratios(kLevels.size()));
  for (const GuardCase& c : options.cases()) {
    figures(c.name, judged_merge(c, options.cache, options.threads), methods, ratios);
  }
  for (std::size_t m = 0; m < methods.size(); ++m) {
    std::printf("%s, times the clairvoyant's, median and greatest:", methods[m].c_str());
    for (std::vector<double>& of_level : ratios[m]) {
      std::ranges::sort(of_level);
      if (!of_level.empty()) std::printf(" %.1f (%.1f)", of_level[of_level.size() / 2], of_level.back());
    }
    std::printf("\n");
  }
  return 0;
}

}  // namespace
}  // namespace mapweld::evaluation

int main(int argc, char** argv) {
  return mapweld::evaluation::tool_main("order_figures", mapweld::evaluation::run_tool, argc, argv);
}
