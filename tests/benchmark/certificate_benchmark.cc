// What the certificate costs, and following lambda_2 as edges arrive. docs/certificate.md holds the figures.
#include <random>
#include <vector>

#include <benchmark/benchmark.h>

#include "core/graph/approximate_cholesky.h"
#include "core/graph/fiedler_iteration.h"
#include "core/graph/sparsify.h"
#include "core/merge/certificate/certificate.h"
#include "core/merge/certificate/final_estimate.h"
#include "core/merge/merge_input.h"
#include "core/merge/merge_metrics.h"
#include "tests/core/graph/sample_graphs.h"

namespace mapweld {
namespace {

// Two walks through the same building, in a ratio of 2 : 1, 5 edges an image, joined by a few edges where they cross.
AppearanceGraph two_walks(std::uint32_t n, std::uint32_t joins) {
  const std::uint32_t first = 2 * n / 3;
  AppearanceGraph graph(n);
  std::mt19937 random(7);
  for (std::uint32_t v = 1; v < n; ++v) {
    const std::uint32_t begin = v < first ? 0 : first;
    if (v == begin) continue;
    graph.add_edge(VertexId{v}, VertexId{v - 1}, 30);
    for (int k = 0; k < 5; ++k) {
      const std::uint32_t back = 1 + random() % 12;
      if (back <= v - begin) graph.add_edge(VertexId{v}, VertexId{v - back}, 20);
    }
  }
  for (std::uint32_t k = 0; k < joins; ++k) {
    const std::uint32_t v = first + random() % (n - first);
    graph.add_edge(VertexId{v}, VertexId{2 * (v - first)}, 15);
  }
  return graph;
}

// Half of the candidates are near the true place and likely to pass, half are anywhere.
std::vector<OpenCandidate> candidates(std::uint32_t n, std::uint32_t count) {
  const std::uint32_t first = 2 * n / 3;
  std::mt19937 random(9);
  std::vector<OpenCandidate> open;
  for (std::uint32_t k = 0; k < count; ++k) {
    const std::uint32_t v = first + random() % (n - first);
    const bool is_near = random() % 2 == 0;
    const std::uint32_t u = is_near ? (2 * (v - first) + random() % 40) % first : random() % first;
    open.push_back({VertexId{u}, VertexId{v}, is_near ? 0.6 : 0.03});
  }
  return open;
}

void report(benchmark::State& state, const Certificate& result) {
  state.counters["certified"] = result.certified_fraction;
  state.counters["iterations"] = result.iterations;
  state.counters["converged"] = result.converged ? 1 : 0;
}

// Arguments: vertices, candidates, joins that stand already.
void Certify(benchmark::State& state) {
  const auto n = static_cast<std::uint32_t>(state.range(0));
  const AppearanceGraph graph = two_walks(n, static_cast<std::uint32_t>(state.range(2)));
  const std::vector<OpenCandidate> open = candidates(n, static_cast<std::uint32_t>(state.range(1)));
  Certificate result;
  for (auto _ : state) result = certify(graph, open);
  report(state, result);
}
#define SIZES                        \
  Args({2000, 20000, 20})            \
      ->Args({2000, 20000, 1000})    \
      ->Args({20000, 200000, 20})    \
      ->Args({20000, 200000, 10000}) \
      ->Unit(benchmark::kMillisecond)
BENCHMARK(Certify)->SIZES;

// The estimate beside it, chances and lambda_2 known.
void EstimateFinal(benchmark::State& state) {
  const auto n = static_cast<std::uint32_t>(state.range(0));
  const AppearanceGraph graph = two_walks(n, static_cast<std::uint32_t>(state.range(2)));
  const std::vector<OpenCandidate> open = candidates(n, static_cast<std::uint32_t>(state.range(1)));
  const LargestComponentConnectivity largest = largest_component_connectivity(graph);
  FinalEstimate result;
  for (auto _ : state) result = estimate_final(graph, largest, open);
  state.counters["estimated"] = result.fraction;
}
BENCHMARK(EstimateFinal)->SIZES;

// Argument 4: ten times the oversampling of the preconditioner.
void CertifyWithLambdaKnown(benchmark::State& state) {
  const auto n = static_cast<std::uint32_t>(state.range(0));
  const AppearanceGraph graph = two_walks(n, static_cast<std::uint32_t>(state.range(2)));
  const std::vector<OpenCandidate> open = candidates(n, static_cast<std::uint32_t>(state.range(1)));
  const LargestComponentConnectivity largest = largest_component_connectivity(graph);
  CertificateOptions options;
  options.iteration.oversampling = 0.1 * static_cast<double>(state.range(3));
  Certificate result;
  for (auto _ : state) result = certify(graph, largest, open, options);
  report(state, result);
  state.counters["lambda2"] = largest.connectivity.value;
}
BENCHMARK(CertifyWithLambdaKnown)
    ->ArgsProduct({{2000}, {20000}, {20, 1000}, {20, 30, 40}})
    ->ArgsProduct({{20000}, {200000}, {20, 10000}, {20, 30, 40}})
    ->Unit(benchmark::kMillisecond);

std::vector<LaplacianEdge> laplacian_edges(const AppearanceGraph& graph) {
  std::vector<LaplacianEdge> edges;
  for (const Edge& e : graph.edge_list()) {
    edges.push_back({static_cast<int>(to_index(e.u)), static_cast<int>(to_index(e.v)), 1.0});
  }
  return edges;
}

// The parts, on graph + all candidates; kind 0: that, 1: random_map with every tenth linked anywhere.
AppearanceGraph part_graph(std::int64_t kind, std::uint32_t n) {
  if (kind == 1) return test::random_map(n, 4, 0.1, 1);
  AppearanceGraph graph = two_walks(n, 20);
  for (const OpenCandidate& c : candidates(n, 10 * n)) graph.add_edge(c.u, c.v, 1);
  return graph;
}

// The preconditioner of graph and all candidates. Arguments: vertices, kind, oversampling.
void ApproximateFactor(benchmark::State& state) {
  const AppearanceGraph graph = part_graph(state.range(1), static_cast<std::uint32_t>(state.range(0)));
  const std::vector<LaplacianEdge> edges = laplacian_edges(graph);
  const int n = static_cast<int>(graph.vertices());
  const auto oversampling = static_cast<double>(state.range(2));
  for (auto _ : state) {
    const ApproximateCholesky factor(n, sparsify(n, edges, oversampling));
    state.counters["entries"] = static_cast<double>(factor.entries());
  }
  state.counters["edges"] = static_cast<double>(edges.size());
  state.counters["kept"] = static_cast<double>(sparsify(n, edges, oversampling).size());
}

// To a residual of 1e-8 from nothing.
void FiedlerIterations(benchmark::State& state) {
  const AppearanceGraph graph = part_graph(state.range(1), static_cast<std::uint32_t>(state.range(0)));
  const std::vector<LaplacianEdge> edges = laplacian_edges(graph);
  const int n = static_cast<int>(graph.vertices());
  const ApproximateCholesky factor(n, sparsify(n, edges, static_cast<double>(state.range(2))));
  FiedlerIteration result;
  for (auto _ : state) result = iterate_to_fiedler(n, edges, factor);
  state.counters["iterations"] = result.iterations;
  state.counters["converged"] = result.converged ? 1 : 0;
  state.counters["lambda2"] = result.value;
}

void parts(benchmark::internal::Benchmark* b) {
  for (const int n : {2000, 20000}) {
    for (const int kind : {0, 1}) {
      for (const int oversampling : {2, 3, 5}) b->Args({n, kind, oversampling});
    }
  }
  b->Unit(benchmark::kMillisecond);
}
BENCHMARK(ApproximateFactor)->Apply(parts);
BENCHMARK(FiedlerIterations)->Apply(parts);

// Metrics asked for after every `range(1)` new inter edges of 2,000, until 2,000 are in. range(2): 0 afresh each time,
// 1 by the follower. range(3): 1 when the edges come place by place, 0 from anywhere.
void FollowMetrics(benchmark::State& state) {
  const auto n = static_cast<std::uint32_t>(state.range(0));
  const std::uint32_t first = 2 * n / 3;
  const std::vector<MergeMember> members = number_members({first, n - first});
  std::vector<MergeEdge> edges;
  std::mt19937 random(3);
  AppearanceGraph seen(n);
  for (std::uint32_t k = 0; edges.size() < 2000; ++k) {
    const std::uint32_t at = state.range(3) == 1 ? k / 10 : static_cast<std::uint32_t>(random());
    MergeEdge e;
    e.v = VertexId{first + at % (n - first)};
    e.u = VertexId{(2 * (to_index(e.v) - first) + static_cast<std::uint32_t>(random() % 20)) % first};
    if (seen.add_edge(e.u, e.v, 1)) edges.push_back(e);
  }
  std::uint64_t computed = 0, asked = 0;
  for (auto _ : state) {
    AppearanceGraph graph = two_walks(n, 0);
    MergeMetricsFollower follower;
    MergeMetrics metrics;
    asked = 0;
    for (std::size_t k = 0; k < edges.size(); ++k) {
      graph.add_edge(edges[k].u, edges[k].v, 20);
      if ((k + 1) % static_cast<std::size_t>(state.range(1)) != 0) continue;
      const std::span<const MergeEdge> inserted(edges.data(), k + 1);
      metrics =
          state.range(2) == 1 ? follower.measure(graph, members, inserted) : merge_metrics(graph, members, inserted);
      ++asked;
    }
    benchmark::DoNotOptimize(metrics);
    computed = follower.eigenvalues_computed();
  }
  state.counters["asked"] = static_cast<double>(asked);
  state.counters["computed"] = static_cast<double>(state.range(2) == 1 ? computed : asked);
}
BENCHMARK(FollowMetrics)
    ->Args({2000, 20, 0, 0})
    ->Args({2000, 20, 1, 0})
    ->Args({2000, 20, 0, 1})
    ->Args({2000, 20, 1, 1})
    ->Args({2000, 1, 1, 1})
    ->Iterations(1)
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace mapweld
