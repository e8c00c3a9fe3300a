// What a merge says of itself beside what turns out to be true: the estimate's table of docs/certificate.md. Merges by
// `spectral` under the guard, from the maps and verdicts that guard_figures keeps in its folder.
//
//   estimate_figures --cache FOLDER                                     the real places
//   estimate_figures --cache FOLDER --scenarios laps --seeds 311 312    rendered ones
//   ... --each   every point of each merge
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>

#include "core/graph/algebraic_connectivity.h"
#include "core/guard/alias_guard.h"
#include "core/merge/certificate/fraction_stop.h"
#include "core/merge/make_merger.h"
#include "core/merge/run.h"
#include "tests/evaluation/guard/case_options.h"
#include "tests/evaluation/guard/judged_merge.h"
#include "tests/evaluation/guard/merge_order.h"
#include "tests/evaluation/tool_main.h"

namespace mapweld::evaluation {
namespace {

constexpr double kFraction = 0.9;  // of the budget that is shown

// The largest component of the confirmed graph.
struct Reached {
  double connectivity = 0;
  double vertices = 0;
};

class GuardedMerge {
 public:
  explicit GuardedMerge(const JudgedMerge& judged)
      : appearances_(judged.merge.appearances()), guard_(judged.merge.members(), judged.inner, appearances_) {
    input_ = known_merge(judged, confirmed_edges(judged.inner, guard_.inner_verdicts()));
  }

  std::unique_ptr<Merger> fresh() const { return make_merger(input_); }
  EdgeJudge judge() {
    return [this](const Merger& merger) { return standings(merger); };
  }
  Reached reached(const Merger& merger) {
    const std::vector<EdgeStanding> standing = standings(merger);
    AppearanceGraph graph(merger.graph().vertices(), input_.inner_edges);
    for (std::size_t e = 0; e < standing.size(); ++e) {
      const MergeEdge& edge = merger.state().edges[e];
      if (standing[e].confirmed) graph.add_edge(edge.u, edge.v, 1);
    }
    const LargestComponentConnectivity largest = largest_component_connectivity(graph);
    return {largest.connectivity.value, static_cast<double>(largest.vertices.size())};
  }

 private:
  std::vector<EdgeStanding> standings(const Merger& merger) {
    std::vector<EdgeStanding> standings;
    for (const GuardVerdict& verdict : guard_.verdicts(merger.state().edges)) {
      standings.push_back({verdict.confirmed(), verdict.confidence});
    }
    return standings;
  }

  AppearanceTable appearances_;
  AliasGuard guard_;
  MergeInput input_;
};

double share(double part, double whole) { return whole > 0 ? part / whole : 1; }

void figures(const std::string& name, const JudgedMerge& judged, bool each) {
  GuardedMerge guarded(judged);
  const auto whole = guarded.fresh();
  run(*whole, {});
  const Reached end = guarded.reached(*whole);
  const std::uint64_t candidates = whole->state().verifications;
  if (candidates == 0) return;

  const auto merger = guarded.fresh();
  Outlook outlook(guarded.judge());
  double error = 0, bias = 0;
  int points = 0;
  std::uint64_t held_from = candidates;  // the fraction is reached and stays so
  for (std::uint64_t next = 8; !merger->done(); next = std::max(next + 4, next * 6 / 5)) {
    run(*merger, stop_at_verifications(next));
    const Reached now = guarded.reached(*merger);
    const double ratio = share(now.connectivity, end.connectivity), vertices = share(now.vertices, end.vertices);
    const bool is_held = std::min(ratio, vertices) >= kFraction;
    held_from = is_held ? std::min(held_from, merger->state().verifications) : candidates;
    if (merger->done()) break;
    const auto told = outlook.estimate(*merger);
    if (each && told) {
      std::printf("| %s | %llu | %.3f | %.3f | %.3f | %.3f | %.3f |\n", name.c_str(),
                  static_cast<unsigned long long>(merger->state().verifications), ratio, told->fraction, vertices,
                  told->vertices_share, outlook.certificate(*merger)->certified_fraction);
    }
    // Above 1 components have still to join, which brings lambda_2 down again.
    if (!told || ratio < 0.5 || ratio > 1.02) continue;
    error += std::abs(told->fraction - std::min(1.0, ratio));
    bias += told->fraction - std::min(1.0, ratio);
    ++points;
  }
  const auto stopped = guarded.fresh();
  run(*stopped, stop_at_fraction(kFraction, false, guarded.judge()));
  const Reached at_stop = guarded.reached(*stopped);
  if (each) return;
  std::printf("| %s | %llu | %.3f | %+.3f | %llu | %llu | %.3f | %.3f |\n", name.c_str(),
              static_cast<unsigned long long>(candidates), points > 0 ? error / points : 0,
              points > 0 ? bias / points : 0, static_cast<unsigned long long>(held_from),
              static_cast<unsigned long long>(stopped->state().verifications),
              share(at_stop.connectivity, end.connectivity), share(at_stop.vertices, end.vertices));
  std::fflush(stdout);
}

int run_tool(int argc, char** argv) {
  CLI::App app{"What a merge says of itself beside what turns out to be true.", "estimate_figures"};
  CaseOptions options;
  bool each = false;
  options.add_to(app);
  app.add_flag("--each", each, "every point of each merge");
  CLI11_PARSE(app, argc, argv);
  if (each) {
    std::printf(
        "| case | verifications | true | estimated | vertices, true | estimated | certified "
        "|\n|---|---|---|---|---|---|---|\n");
  } else {
    std::printf(
        "| case | candidates | mean error | bias | 0.9 held from | stops at | truth there | vertices there |\n");
    std::printf("|---|---|---|---|---|---|---|---|\n");
  }
  for (const GuardCase& c : options.cases()) figures(c.name, judged_merge(c, options.cache, options.threads), each);
  return 0;
}

}  // namespace
}  // namespace mapweld::evaluation

int main(int argc, char** argv) {
  return mapweld::evaluation::tool_main("estimate_figures", mapweld::evaluation::run_tool, argc, argv);
}
