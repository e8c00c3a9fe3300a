// What the alias guard confirms, with the truth beside: the tables of docs/alias-guard.md.
//
//   alias_guard_figures --cache FOLDER --seeds 11 12 13          rendered scenarios; merges are kept in FOLDER
//   alias_guard_figures --cache FOLDER --scenarios photographs   the photographs of MAPWELD_PHOTOS
//   ... --list                                                   every wrong edge that is confirmed
#include <algorithm>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <iostream>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <opencv2/core/utility.hpp>

#include "core/feature/allocation.h"
#include "core/graph/algebraic_connectivity.h"
#include "core/graph/components.h"
#include "core/merge/alias_guard.h"
#include "core/merge/hop_balls.h"
#include "tests/core/geometry/photographs.h"
#include "tests/support/merge_scenarios.h"

namespace mapweld::rendered {
namespace {

constexpr float kRight = 0.1f;       // an edge is right when both images see so much of each other
constexpr float kJoinable = 0.3f;    // a vertex of b is joinable when it shares so much with one of a
constexpr std::size_t kEnough = 50;  // and has so many features

AliasGuardOptions tuned;

struct Figures {
  std::size_t verified = 0, right = 0;
  std::size_t confirmed = 0, confirmed_right = 0, ambiguous = 0;
  std::size_t joinable = 0, joined_by_verified = 0, joined = 0;  // vertices of b; joined: by a right edge
  std::size_t wrong_joins = 0;                                   // clusters of confirmed edges without a right one
  std::size_t wrong_joins_verified = 0;                          // the same before the guard
  double lambda_all = 0, lambda_right = 0;
  double elapsed_ms = 0;

  void add(const Figures& other) {
    verified += other.verified;
    right += other.right;
    confirmed += other.confirmed;
    confirmed_right += other.confirmed_right;
    ambiguous += other.ambiguous;
    joinable += other.joinable;
    joined_by_verified += other.joined_by_verified;
    joined += other.joined;
    wrong_joins += other.wrong_joins;
    wrong_joins_verified += other.wrong_joins_verified;
    lambda_all += other.lambda_all;
    lambda_right += other.lambda_right;
    elapsed_ms += other.elapsed_ms;
  }
};

// Clusters of the edges `which` (within two hops of each other in both maps) that have no right edge among them.
std::size_t wrong_joins(const MadeMerge& merge, const std::vector<std::size_t>& which) {
  HopBalls balls(merge.members(), merge.inner_edges(), 2);
  const auto vertices = balls.vertices();
  std::vector<std::vector<std::size_t>> at(vertices);
  for (const std::size_t e : which) at[to_index(merge.inter_edges[e].u)].push_back(e);
  std::vector<bool> seen(merge.inter_edges.size(), false);
  std::size_t count = 0;
  for (const std::size_t start : which) {
    if (seen[start]) continue;
    seen[start] = true;
    std::vector<std::size_t> cluster{start};
    bool has_right = false;
    for (std::size_t i = 0; i < cluster.size(); ++i) {
      const MergeEdge& e = merge.inter_edges[cluster[i]];
      has_right |= merge.shared[cluster[i]] >= kRight;
      std::vector<bool> near(vertices, false);
      for (const auto& r : balls.around(e.v)) near[r.vertex] = true;
      for (const auto& r : balls.around(e.u)) {
        for (const std::size_t f : at[r.vertex]) {
          if (seen[f] || !near[to_index(merge.inter_edges[f].v)]) continue;
          seen[f] = true;
          cluster.push_back(f);
        }
      }
    }
    count += has_right ? 0 : 1;
  }
  return count;
}

AppearanceGraph merged_graph(const MadeMerge& merge, const std::vector<std::size_t>& which) {
  AppearanceGraph graph(static_cast<std::uint32_t>(merge.a.vertices.size() + merge.b.vertices.size()),
                        merge.inner_edges());
  for (const std::size_t e : which) {
    const MergeEdge& edge = merge.inter_edges[e];
    graph.add_edge(edge.u, edge.v, static_cast<std::uint32_t>(edge.verification.inliers));
  }
  return graph;
}

// lambda_2 of the largest component that the edges `which` make; and of the same vertices with its right edges alone.
void compare_connectivity(const MadeMerge& merge, const std::vector<std::size_t>& which, Figures& figures) {
  const AppearanceGraph all = merged_graph(merge, which);
  std::vector<std::size_t> right;
  std::ranges::copy_if(which, std::back_inserter(right), [&](std::size_t e) { return merge.shared[e] >= kRight; });
  const Components components = connected_components(all);
  const auto kept = components.vertices_of(components.largest());
  figures.lambda_all = algebraic_connectivity(induced_subgraph(all, kept)).value;
  figures.lambda_right = algebraic_connectivity(induced_subgraph(merged_graph(merge, right), kept)).value;
}

Figures measure(const MadeMerge& merge, bool list, const std::string& title) {
  const auto members = merge.members();
  const auto inner = merge.inner_edges();
  const AppearanceTable appearances = merge.appearances();
  Figures figures;
  const auto start = std::chrono::steady_clock::now();
  const auto verdicts = guard_edges(members, inner, merge.inter_edges, appearances, tuned);
  figures.elapsed_ms = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();

  const auto shift = merge.a.vertices.size();
  std::vector<std::size_t> all, confirmed;
  std::vector<bool> has_right(merge.b.vertices.size(), false), has_confirmed(merge.b.vertices.size(), false);
  for (std::size_t e = 0; e < verdicts.size(); ++e) {
    const MergeEdge& edge = merge.inter_edges[e];
    const bool right = merge.shared[e] >= kRight;
    all.push_back(e);
    figures.right += right ? 1 : 0;
    figures.ambiguous += verdicts[e].reason == Reason::kAmbiguous ? 1 : 0;
    if (right) has_right[to_index(edge.v) - shift] = true;
    if (!verdicts[e].confirmed()) continue;
    confirmed.push_back(e);
    figures.confirmed_right += right ? 1 : 0;
    if (right) has_confirmed[to_index(edge.v) - shift] = true;
    if (list && !right) {
      const GuardEvidence& x = verdicts[e].evidence;
      std::printf(
          "  wrong: %s %u %zu shares %.3f: %d inliers, 10^%.1f, full %.2f, matched %.2f, view %.2f, spread %.2f, rare "
          "%d, cluster "
          "of %u, "
          "%llu for, %llu against\n",
          title.c_str(), to_index(edge.u), to_index(edge.v) - shift, merge.shared[e], edge.verification.inliers,
          edge.verification.log10_false_alarms, x.fullness, x.matched_share, x.shared_view, x.spread, x.rare_matches,
          x.cluster_edges, static_cast<unsigned long long>(x.support),
          static_cast<unsigned long long>(x.contradiction));
    }
  }
  figures.verified = all.size();
  figures.confirmed = confirmed.size();
  for (std::size_t v = 0; v < has_right.size(); ++v) {
    if (merge.best_shared[v] < kJoinable || merge.b.vertices[v]->appearances.size() < kEnough) continue;
    ++figures.joinable;
    figures.joined_by_verified += has_right[v] ? 1 : 0;
    figures.joined += has_confirmed[v] ? 1 : 0;
  }
  figures.wrong_joins = wrong_joins(merge, confirmed);
  figures.wrong_joins_verified = wrong_joins(merge, all);
  compare_connectivity(merge, confirmed, figures);
  return figures;
}

std::string share(std::size_t part, std::size_t whole) {
  if (whole == 0) return "-";
  char text[16];
  std::snprintf(text, sizeof text, "%.2f", 100.0 * static_cast<double>(part) / static_cast<double>(whole));
  return text;
}

void print_head() {
  std::printf(
      "| scenario | verified | right | wrong | wrong joins | confirmed | wrong | precision %% | of the right %% | "
      "ambiguous | wrong joins | places | joined before | joined | %% | lambda_2 right / all | ms |\n"
      "|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|\n");
}

void print(const std::string& title, const Figures& f) {
  std::printf("| %s | %zu | %zu | %zu | %zu | %zu | %zu | %s | %s | %zu | %zu | %zu | %zu | %zu | %s | %.3f | %.1f |\n",
              title.c_str(), f.verified, f.right, f.verified - f.right, f.wrong_joins_verified, f.confirmed,
              f.confirmed - f.confirmed_right, share(f.confirmed_right, f.confirmed).c_str(),
              share(f.confirmed_right, f.right).c_str(), f.ambiguous, f.wrong_joins, f.joinable, f.joined_by_verified,
              f.joined, share(f.joined, f.joinable).c_str(), f.lambda_all > 0 ? f.lambda_right / f.lambda_all : 1,
              f.elapsed_ms);
  std::fflush(stdout);
}

MadeMerge cached(const std::filesystem::path& folder, std::string_view name, std::uint64_t seed, int threads) {
  const auto file = folder / (std::string(name) + "-" + std::to_string(seed) + ".merge");
  if (std::filesystem::exists(file)) return read_merge(file);
  static const auto vocabulary = shipped_vocabulary();
  MadeMerge merge = make_scenario(name, seed, *vocabulary, threads);
  write_merge(merge, file);
  return merge;
}

// ---- Photographs: no truth but what docs/verification.md says; what is dropped is told ----------------------------

MadeMap map_of(const std::string& folder) {
  std::vector<AppearanceVector> images;
  for (const auto& photograph : test::photographs(folder)) images.push_back(photograph.appearances);
  return make_map(images);
}

void photographs(int threads, bool list) {
  std::printf(
      "| photographs | vertices | verified | confirmed | unsupported | ambiguous | vertices of b joined before | "
      "joined |\n|---|---|---|---|---|---|---|---|\n");
  const std::vector<std::pair<std::string, std::string>> pairs{
      {"corridor-two-laps/lap-1", "corridor-two-laps/lap-2"},
      {"office-two-runs/live", "office-two-runs/reference"},
      {"places-two-visits/magasin/A", "places-two-visits/magasin/B"},
      {"places-two-visits/studio/A", "places-two-visits/studio/B"},
      {"office-two-runs/live", "corridor-two-laps/lap-2"}};
  for (const auto& [a, b] : pairs) {
    const MadeMerge merge = verify_all(map_of(a), map_of(b), threads);
    const auto verdicts =
        guard_edges(merge.members(), merge.inner_edges(), merge.inter_edges, merge.appearances(), tuned);
    std::size_t counts[3] = {};
    std::vector<std::uint32_t> before, after;
    for (std::size_t e = 0; e < verdicts.size(); ++e) {
      const Reason reason = verdicts[e].reason;
      ++counts[reason == Reason::kNone ? 0 : reason == Reason::kUnsupported ? 1 : 2];
      before.push_back(to_index(merge.inter_edges[e].v));
      if (verdicts[e].confirmed()) after.push_back(before.back());
      if (list) {
        const GuardEvidence& x = verdicts[e].evidence;
        std::printf(
            "  %s %u %zu: %d inliers, 10^%.1f, full %.1f, matched %.2f, view %.2f, spread %.2f, rare %d, cluster of "
            "%u, %llu for, "
            "%llu against: %s\n",
            b.c_str(), to_index(merge.inter_edges[e].u), before.back() - merge.a.vertices.size(),
            merge.inter_edges[e].verification.inliers, merge.inter_edges[e].verification.log10_false_alarms, x.fullness,
            x.matched_share, x.shared_view, x.spread, x.rare_matches, x.cluster_edges,
            static_cast<unsigned long long>(x.support), static_cast<unsigned long long>(x.contradiction),
            verdicts[e].confirmed() ? "confirmed" : std::string(to_string(reason)).c_str());
      }
    }
    const auto distinct = [](std::vector<std::uint32_t>& v) {
      std::ranges::sort(v);
      return static_cast<std::size_t>(std::ranges::unique(v).begin() - v.begin());
    };
    std::printf("| %s, %s | %zu + %zu | %zu | %zu | %zu | %zu | %zu | %zu |\n", a.c_str(), b.c_str(),
                merge.a.vertices.size(), merge.b.vertices.size(), verdicts.size(), counts[0], counts[1], counts[2],
                distinct(before), distinct(after));
  }
}

int run(int argc, char** argv) {
  CLI::App app{"What the alias guard confirms, with the truth beside.", "alias_guard_figures"};
  std::string cache = ".";
  std::vector<std::string> names;
  std::vector<std::uint64_t> seeds{1};
  bool list = false, each = false, only_cached = false;
  int threads = 1;
  app.add_option("--cache", cache, "folder of merges made before, and where new ones go")
      ->check(CLI::ExistingDirectory);
  app.add_option("--scenarios", names, "some of the list only, or `photographs`");
  app.add_option("--seeds", seeds, "buildings and drives");
  app.add_option("--threads", threads, "for rendering and verifying; change no figure");
  app.add_flag("--list", list, "every wrong edge that is confirmed");
  app.add_flag("--each", each, "a line for each seed as well");
  app.add_flag("--only-cached", only_cached, "leaves out what is not in the cache yet");
  app.add_option("--dropped-beyond", tuned.dropped_beyond, "an option of the guard");
  app.add_option("--ambiguous-beyond", tuned.ambiguous_beyond, "an option of the guard");
  app.add_option("--min-rare-matches", tuned.min_rare_matches, "an option of the guard");
  app.add_option("--min-matched-share", tuned.min_matched_share, "an option of the guard");
  app.add_option("--min-shared-view", tuned.min_shared_view, "an option of the guard");
  app.add_option("--min-spread", tuned.min_spread, "an option of the guard");
  app.add_option("--max-log10-false-alarms", tuned.max_log10_false_alarms, "an option of the guard");
  app.add_option("--near-hops", tuned.near_hops, "an option of the guard");
  app.add_option("--far-hops", tuned.far_hops, "an option of the guard");
  app.add_option("--link-hops", tuned.link_hops, "an option of the guard");
  app.add_option("--min-fullness", tuned.min_fullness, "an option of the guard");
  app.add_option("--min-best-fullness", tuned.min_best_fullness, "an option of the guard");
  app.add_option("--min-best-matched-share", tuned.min_best_matched_share, "an option of the guard");
  app.add_option("--min-vertex-fullness", tuned.min_vertex_fullness, "an option of the guard");
  app.add_option("--min-full-vertices", tuned.min_full_vertices, "an option of the guard");
  app.add_option("--sure-peak-fullness", tuned.sure_peak_fullness, "an option of the guard");
  app.add_option("--min-link-share", tuned.min_link_share, "an option of the guard");
  app.add_option("--rival-hops", tuned.rival_hops, "an option of the guard");
  app.add_option("--min-peak-fullness", tuned.min_peak_fullness, "an option of the guard");
  app.add_option("--duel-significance", tuned.duel_significance, "an option of the guard");
  app.add_option("--revisit-fullness", tuned.revisit_fullness, "an option of the guard");
  app.add_option("--revisit-completeness", tuned.revisit_completeness, "an option of the guard");
  app.add_option("--longest-link", tuned.longest_link, "an option of the guard");
  CLI11_PARSE(app, argc, argv);
  cv::setNumThreads(1);
  keep_freed_memory();
  if (names == std::vector<std::string>{"photographs"}) {
    photographs(threads, list);
    return 0;
  }
  print_head();
  Figures told_apart;
  for (const MergeScenario& scenario : merge_scenarios()) {
    if (!names.empty() && std::ranges::find(names, scenario.name) == names.end()) continue;
    Figures sum;
    for (const std::uint64_t seed : seeds) {
      const std::string title = std::string(scenario.name) + " " + std::to_string(seed);
      const auto file =
          std::filesystem::path(cache) / (std::string(scenario.name) + "-" + std::to_string(seed) + ".merge");
      if (only_cached && !std::filesystem::exists(file)) continue;
      const Figures figures = measure(cached(cache, scenario.name, seed, threads), list, title);
      if (each) print(title, figures);
      sum.add(figures);
    }
    print(std::string(scenario.name), sum);
    if (scenario.told_apart) told_apart.add(sum);
  }
  print("all that the guard tells apart", told_apart);
  return 0;
}

}  // namespace
}  // namespace mapweld::rendered

int main(int argc, char** argv) {
  try {
    return mapweld::rendered::run(argc, argv);
  } catch (const std::exception& error) {
    std::cerr << "alias_guard_figures: " << error.what() << "\n";
    return 1;
  }
}
