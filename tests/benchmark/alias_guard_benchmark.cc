// How long the alias guard takes: docs/alias-guard.md.
//
//   alias_guard_benchmark        two robots on one loop, so many inter-map edges
#include <algorithm>
#include <cmath>
#include <memory>
#include <random>
#include <vector>

#include <benchmark/benchmark.h>

#include "core/merge/alias_guard.h"

namespace mapweld {
namespace {

struct Merge {
  std::vector<MergeMember> members;
  std::vector<Edge> inner;
  std::vector<MergeEdge> edges;
  std::unique_ptr<AppearanceTable> appearances;
};

// Images of 400 features along one loop, the words of neighbours overlapping; each image is linked to the six before
// it. Edges join images at about the same place, and one in twenty joins two places anywhere.
Merge make_merge(std::uint32_t n1, std::uint32_t n2, std::uint32_t edges) {
  Merge merge;
  merge.members = number_members({n1, n2});
  std::mt19937_64 random(1);
  const auto below = [&](std::uint32_t n) { return static_cast<std::uint32_t>(random() % n); };
  std::vector<std::shared_ptr<const AppearanceVector>> vectors;
  for (std::size_t m = 0; m < 2; ++m) {
    const std::uint32_t n = m == 0 ? n1 : n2;
    for (std::uint32_t i = 0; i < n; ++i) {
      AppearanceVector image{.width_px = 320, .height_px = 240, .appearances = {}};
      const auto first = static_cast<std::uint32_t>(49000.0 * i / n);
      for (int f = 0; f < 400; ++f) {
        image.appearances.push_back({WordId{f % 4 == 0 ? below(50000) : first + below(1000)},
                                     static_cast<float>(below(2560)) / 8, static_cast<float>(below(1920)) / 8, 4, 0});
      }
      std::ranges::sort(image.appearances);
      vectors.push_back(std::make_shared<const AppearanceVector>(std::move(image)));
      const std::uint32_t v = to_index(merge.members[m].vertices[i]);
      for (std::uint32_t back = 1; back <= 6 && back <= i; ++back)
        merge.inner.push_back({VertexId{v - back}, VertexId{v}, 50});
    }
  }
  for (std::uint32_t k = 0; k < edges; ++k) {
    MergeEdge edge;
    const std::uint32_t j = below(n2);
    const std::uint32_t there = static_cast<std::uint32_t>(1.0 * j / n2 * n1) + below(31);
    edge.u = VertexId{k % 20 == 0 ? below(n1) : std::min(n1 - 1, there < 15 ? 0 : there - 15)};
    edge.v = VertexId{n1 + j};
    edge.verification.accepted = true;
    edge.verification.inliers = 30;
    edge.verification.log10_false_alarms = -40;
    for (std::uint16_t m = 0; m < 30; ++m) {
      edge.verification.inlier_matches.emplace_back(static_cast<std::uint16_t>(13 * m),
                                                    static_cast<std::uint16_t>(13 * m));
    }
    merge.edges.push_back(std::move(edge));
  }
  std::ranges::sort(merge.edges, {}, [](const MergeEdge& e) { return std::pair(e.u, e.v); });
  const auto last = std::unique(merge.edges.begin(), merge.edges.end(),
                                [](const MergeEdge& a, const MergeEdge& b) { return a.u == b.u && a.v == b.v; });
  merge.edges.erase(last, merge.edges.end());
  merge.appearances = std::make_unique<AppearanceTable>(std::move(vectors));
  return merge;
}

void BM_GuardEdges(benchmark::State& state) {
  const Merge merge = make_merge(static_cast<std::uint32_t>(state.range(0)), static_cast<std::uint32_t>(state.range(1)),
                                 static_cast<std::uint32_t>(state.range(2)));
  // The matches are no geometry: every pair is taken to show enough, so that all the work is done.
  AliasGuardOptions options;
  options.min_matched_share = options.min_shared_view = options.min_spread = 0;
  for (auto _ : state) {
    benchmark::DoNotOptimize(guard_edges(merge.members, merge.inner, merge.edges, *merge.appearances, options));
  }
  state.counters["edges"] = static_cast<double>(merge.edges.size());
}
// The same edges again, as at the next checkpoint of a running merge.
void BM_GuardAgain(benchmark::State& state) {
  const Merge merge = make_merge(static_cast<std::uint32_t>(state.range(0)), static_cast<std::uint32_t>(state.range(1)),
                                 static_cast<std::uint32_t>(state.range(2)));
  AliasGuardOptions options;
  options.min_matched_share = options.min_shared_view = options.min_spread = 0;
  AliasGuard guard(merge.members, merge.inner, *merge.appearances, options);
  guard.verdicts(merge.edges);
  for (auto _ : state) benchmark::DoNotOptimize(guard.verdicts(merge.edges));
}
BENCHMARK(BM_GuardAgain)->ArgNames({"m1", "m2", "edges"})->Args({1356, 610, 12000})->Unit(benchmark::kMillisecond);
BENCHMARK(BM_GuardEdges)
    ->ArgNames({"m1", "m2", "edges"})
    ->Args({1356, 610, 2500})
    ->Args({1356, 610, 5000})
    ->Args({1356, 610, 12000})
    ->Args({6000, 6000, 50000})
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace mapweld
