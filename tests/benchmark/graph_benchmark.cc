// What the graph costs at the sizes of real maps. docs/merging.md holds the figures.
#include <random>
#include <utility>
#include <vector>

#include <benchmark/benchmark.h>

#include "core/graph/algebraic_connectivity.h"
#include "core/graph/components.h"
#include "core/graph/edge_connectivity.h"
#include "core/graph/matching.h"
#include "tests/core/graph/sample_graphs.h"

namespace mapweld {
namespace {

// Two walks through the same building, 4 links an image to its last dozen, and a link from every tenth to anywhere in
// the past (a loop closed).
AppearanceGraph building(std::int64_t vertices) {
  return test::random_map(static_cast<std::uint32_t>(vertices), 4, 0.1, 1);
}

void AlgebraicConnectivityOfABuilding(benchmark::State& state) {
  const AppearanceGraph graph = building(state.range(0));
  AlgebraicConnectivity result;
  for (auto _ : state) result = algebraic_connectivity(graph);
  state.counters["lambda2"] = result.value;
  state.counters["solver"] = static_cast<double>(result.solver);
  state.counters["edges"] = static_cast<double>(graph.edges());
}
BENCHMARK(AlgebraicConnectivityOfABuilding)->Arg(500)->Arg(2000)->Arg(20000)->Unit(benchmark::kMillisecond);

// The other solver than the one that is chosen: argument 2 is the multiplications allowed for each vertex.
void AlgebraicConnectivityBy(benchmark::State& state) {
  const AppearanceGraph graph =
      test::random_map(static_cast<std::uint32_t>(state.range(0)), 4, 0.01 * static_cast<double>(state.range(1)), 1);
  AlgebraicConnectivityOptions options;
  options.max_factor_work_per_vertex = static_cast<double>(state.range(2));
  AlgebraicConnectivity result;
  for (auto _ : state) result = algebraic_connectivity(graph, options);
  state.counters["lambda2"] = result.value;
  state.counters["solver"] = static_cast<double>(result.solver);
}
BENCHMARK(AlgebraicConnectivityBy)
    ->ArgsProduct({{500, 2000, 20000}, {0, 1, 3, 10}, {0, 200, 500, 2000, 1000000}})
    ->Unit(benchmark::kMillisecond);

// Nothing but a walk: the factor stays thin.
void AlgebraicConnectivityOfAWalk(benchmark::State& state) {
  const AppearanceGraph graph = test::random_map(static_cast<std::uint32_t>(state.range(0)), 4, 0, 1);
  AlgebraicConnectivity result;
  for (auto _ : state) result = algebraic_connectivity(graph);
  state.counters["lambda2"] = result.value;
}
BENCHMARK(AlgebraicConnectivityOfAWalk)->Arg(2000)->Arg(20000)->Arg(200000)->Unit(benchmark::kMillisecond);

// Long-range edges everywhere fill the factor: conjugate gradients take over.
void AlgebraicConnectivityOfAnExpander(benchmark::State& state) {
  const auto n = static_cast<std::uint32_t>(state.range(0));
  AppearanceGraph graph = test::random_graph(n, 10.0 / static_cast<double>(n), 1);
  for (std::uint32_t v = 1; v < n; ++v) graph.add_edge(VertexId{v}, VertexId{v - 1}, 20);
  AlgebraicConnectivity result;
  for (auto _ : state) result = algebraic_connectivity(graph);
  state.counters["lambda2"] = result.value;
  state.counters["solver"] = static_cast<double>(result.solver);
}
BENCHMARK(AlgebraicConnectivityOfAnExpander)->Arg(2000)->Arg(6000)->Unit(benchmark::kMillisecond);

void EdgeConnectivity(benchmark::State& state) {
  const AppearanceGraph graph = building(state.range(0));
  std::uint32_t result = 0;
  for (auto _ : state) result = edge_connectivity(graph);
  state.counters["cut"] = result;
  state.counters["edges"] = static_cast<double>(graph.edges());
}
BENCHMARK(EdgeConnectivity)->Arg(2000)->Arg(20000)->Unit(benchmark::kMillisecond);

// The hard case: no vertex of small degree, so that no cut is found at once.
void EdgeConnectivityOfARandomGraph(benchmark::State& state) {
  const auto n = static_cast<std::uint32_t>(state.range(0));
  const AppearanceGraph graph = test::random_graph(n, 20.0 / static_cast<double>(n), 1);
  std::uint32_t result = 0;
  for (auto _ : state) result = edge_connectivity(graph);
  state.counters["cut"] = result;
}
BENCHMARK(EdgeConnectivityOfARandomGraph)->Arg(2000)->Unit(benchmark::kMillisecond);

void Components(benchmark::State& state) {
  const AppearanceGraph graph = building(state.range(0));
  for (auto _ : state) benchmark::DoNotOptimize(connected_components(graph));
}
BENCHMARK(Components)->Arg(2000)->Arg(20000)->Unit(benchmark::kMicrosecond);

// Ten inter edges for each image of the smaller map.
void IndependentJoins(benchmark::State& state) {
  const auto images = static_cast<std::uint32_t>(state.range(0));
  std::mt19937 random(1);
  std::vector<std::pair<VertexId, VertexId>> edges;
  for (std::uint32_t v = 0; v < images; ++v) {
    for (int k = 0; k < 10; ++k) {
      edges.emplace_back(VertexId{v},
                         VertexId{static_cast<std::uint32_t>(images + (2 * v + random() % 40) % (2 * images))});
    }
  }
  for (auto _ : state) benchmark::DoNotOptimize(maximum_matching(edges));
}
BENCHMARK(IndependentJoins)->Arg(610)->Arg(2000)->Unit(benchmark::kMillisecond);

// As many in all between three maps; of images with few edges, where many stay without a mate.
void IndependentJoinsOfThree(benchmark::State& state) {
  const auto edge_count = static_cast<std::uint32_t>(state.range(0));
  const std::uint32_t images = 3 * edge_count / 10;
  std::mt19937 random(1);
  std::vector<std::pair<VertexId, VertexId>> edges;
  for (std::uint32_t k = 0; k < edge_count; ++k) {
    const auto first = static_cast<std::uint32_t>(random() % 3);
    const auto second = static_cast<std::uint32_t>((first + 1 + random() % 2) % 3);
    edges.emplace_back(VertexId{static_cast<std::uint32_t>(first * images + random() % images)},
                       VertexId{static_cast<std::uint32_t>(second * images + random() % images)});
  }
  for (auto _ : state) benchmark::DoNotOptimize(maximum_matching(edges));
}
BENCHMARK(IndependentJoinsOfThree)->Arg(6100)->Arg(20000)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace mapweld
