// How long the alias guard takes: docs/alias-guard.md.
//
//   guard_benchmark        two robots on one loop, so many edges between maps
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <random>
#include <span>
#include <utility>
#include <vector>

#include <benchmark/benchmark.h>

#include "core/guard/alias_guard.h"

namespace mapweld {
namespace {

constexpr std::uint16_t kFeatures = 400;
constexpr std::uint16_t kInliers = 60;

struct Merge {
  std::vector<MergeMember> members;
  std::vector<VerifiedEdge> inner;
  std::vector<MergeEdge> edges;
  std::unique_ptr<AppearanceTable> appearances;
};

std::vector<std::pair<std::uint16_t, std::uint16_t>> some_matches() {
  std::vector<std::pair<std::uint16_t, std::uint16_t>> matches;
  for (std::uint16_t m = 0; m < kInliers; ++m) {
    const auto feature = static_cast<std::uint16_t>(m * (kFeatures / kInliers));
    matches.emplace_back(feature, feature);
  }
  return matches;
}

// Images along one loop, the words of neighbours overlapping and one feature in four anywhere, with signatures; each
// image is linked to the `links` before it. Edges join images at about the same place, and one in twenty two places
// anywhere.
Merge make_merge(std::uint32_t n1, std::uint32_t n2, std::uint32_t links, std::uint32_t edges) {
  Merge merge;
  merge.members = number_members({n1, n2});
  std::mt19937_64 random(1);
  const auto below = [&](std::uint32_t n) { return static_cast<std::uint32_t>(random() % n); };
  const auto matches = some_matches();
  std::vector<std::shared_ptr<const AppearanceVector>> vectors;
  for (std::size_t m = 0; m < 2; ++m) {
    const std::uint32_t n = m == 0 ? n1 : n2;
    for (std::uint32_t i = 0; i < n; ++i) {
      AppearanceVector image{.width_px = 320, .height_px = 240, .appearances = {}};
      const auto first = static_cast<std::uint32_t>(49000.0 * i / n);
      for (int f = 0; f < kFeatures; ++f) {
        Appearance feature{WordId{f % 4 == 0 ? below(50000) : first + below(1000)}, static_cast<float>(below(2560)) / 8,
                           static_cast<float>(below(1920)) / 8, 4, 0};
        for (auto& part : feature.signature.bits) part = random();
        image.appearances.push_back(feature);
      }
      std::ranges::sort(image.appearances);
      vectors.push_back(std::make_shared<const AppearanceVector>(std::move(image)));
      const std::uint32_t v = to_index(merge.members[m].vertices[i]);
      for (std::uint32_t back = 1; back <= links && back <= i; ++back) {
        merge.inner.push_back({VertexId{v - back}, VertexId{v}, matches});
      }
    }
  }
  std::vector<std::pair<std::uint32_t, std::uint32_t>> ends;
  const std::uint32_t beside = std::max(15U, edges / n2);
  while (ends.size() < edges) {
    for (std::size_t k = ends.size(); k < edges; ++k) {
      const std::uint32_t j = below(n2);
      const auto there = static_cast<std::uint32_t>(1.0 * j / n2 * n1) + below(2 * beside + 1);
      ends.emplace_back(k % 20 == 0 ? below(n1) : std::min(n1 - 1, there < beside ? 0 : there - beside), n1 + j);
    }
    std::ranges::sort(ends);
    ends.erase(std::ranges::unique(ends).begin(), ends.end());
  }
  std::ranges::shuffle(ends, random);
  for (const auto& [u, v] : ends) {
    MergeEdge edge;
    edge.u = VertexId{u};
    edge.v = VertexId{v};
    edge.verification.accepted = true;
    edge.verification.inliers = kInliers;
    edge.verification.inlier_matches = matches;
    merge.edges.push_back(std::move(edge));
  }
  merge.appearances = std::make_unique<AppearanceTable>(std::move(vectors));
  return merge;
}

Merge make_merge(const benchmark::State& state) {
  const auto at = [&](std::size_t i) { return static_cast<std::uint32_t>(state.range(i)); };
  return make_merge(at(0), at(1), at(2), at(3));
}

// What a merge does once when it begins or goes on: both maps judged by themselves.
void BM_GuardMembers(benchmark::State& state) {
  const Merge merge = make_merge(state);
  for (auto _ : state) {
    AliasGuard guard(merge.members, merge.inner, *merge.appearances);
    benchmark::DoNotOptimize(guard.inner_verdicts().data());
  }
  state.counters["inner"] = static_cast<double>(merge.inner.size());
}

// The edges in so many batches, each time all verdicts, as at the checkpoints of a merge. Without the members.
void judge_in_batches(benchmark::State& state, std::size_t batches) {
  const Merge merge = make_merge(state);
  for (auto _ : state) {
    state.PauseTiming();
    AliasGuard guard(merge.members, merge.inner, *merge.appearances);
    state.ResumeTiming();
    for (std::size_t k = 1; k <= batches; ++k) {
      const std::span<const MergeEdge> so_far(merge.edges.data(), merge.edges.size() * k / batches);
      benchmark::DoNotOptimize(guard.verdicts(so_far).data());
    }
  }
  state.counters["edges"] = static_cast<double>(merge.edges.size());
}
void BM_GuardEdges(benchmark::State& state) { judge_in_batches(state, 1); }
void BM_GuardEdgesInBatches(benchmark::State& state) { judge_in_batches(state, 100); }

void sizes(benchmark::internal::Benchmark* b) {
  b->ArgNames({"m1", "m2", "links", "edges"})
      ->Args({1356, 610, 6, 2500})
      ->Args({1356, 610, 6, 5000})
      ->Args({1356, 610, 6, 12000})
      ->Args({6000, 6000, 6, 50000})
      ->Args({300, 300, 60, 15000})
      ->Unit(benchmark::kMillisecond);
}
BENCHMARK(BM_GuardMembers)->Apply(sizes);
BENCHMARK(BM_GuardEdges)->Apply(sizes);
BENCHMARK(BM_GuardEdgesInBatches)->Apply(sizes);

}  // namespace
}  // namespace mapweld
