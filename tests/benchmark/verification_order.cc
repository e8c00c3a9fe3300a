// How many verifications each method needs to reach a share of the final algebraic connectivity; docs/spectral.md holds
// the figures.
#include <algorithm>
#include <cstdio>
#include <ctime>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "core/geometry/epipolar_verifier.h"
#include "core/graph/algebraic_connectivity.h"
#include "core/graph/components.h"
#include "core/merge/limit/clairvoyant.h"
#include "core/merge/make_merger.h"
#include "core/merge/run.h"
#include "core/merge/vote_source.h"
#include "tests/benchmark/stored_pair.h"

namespace mapweld {
namespace {

const std::vector<double> kShares{0.5, 0.9, 0.95, 0.96, 0.99};

// An edge and the number of verifications after which it was there.
struct TimedEdge {
  Edge edge;
  std::uint64_t verifications = 0;
};

// lambda_2 of the graph induced on the finished graph's largest component, as edges arrive. It only grows, so that a
// share of the final value is found by bisection.
class FinalComponent {
 public:
  FinalComponent(std::uint32_t vertices, const std::vector<Edge>& inner, const std::vector<Edge>& all) {
    AppearanceGraph graph(vertices);
    for (const Edge& e : all) graph.add_edge(e.u, e.v, e.weight);
    const Components components = connected_components(graph);
    vertices_ = components.vertices_of(components.largest());
    number_.assign(vertices, kOutside);
    for (std::uint32_t i = 0; i < vertices_.size(); ++i) number_[to_index(vertices_[i])] = i;
    base_ = AppearanceGraph(static_cast<std::uint32_t>(vertices_.size()));
    for (const Edge& e : inner) add(base_, e);
  }
  double connectivity(const std::vector<TimedEdge>& edges, std::size_t count) const {
    AppearanceGraph graph = base_;
    for (std::size_t i = 0; i < count; ++i) add(graph, edges[i].edge);
    return algebraic_connectivity(graph).value;
  }
  // Verifications until `value` is reached.
  std::uint64_t reached(const std::vector<TimedEdge>& edges, double value) const {
    if (connectivity(edges, 0) >= value) return 0;
    std::size_t low = 0, high = edges.size();  // below it at low, reached at high
    while (high - low > 1) {
      const std::size_t middle = (low + high) / 2;
      (connectivity(edges, middle) >= value ? high : low) = middle;
    }
    return edges[high - 1].verifications;
  }
  // Edges until each share of `value`, for one who knows which candidates pass.
  std::vector<std::size_t> clairvoyant(const std::vector<TimedEdge>& edges, double value) const {
    std::vector<std::pair<VertexId, VertexId>> ends;
    for (const TimedEdge& e : edges) {
      const std::uint32_t u = number_[to_index(e.edge.u)], v = number_[to_index(e.edge.v)];
      if (u != kOutside && v != kOutside) ends.emplace_back(VertexId{u}, VertexId{v});
    }
    const std::vector<ClairvoyantPick> picks = clairvoyant_order(base_, ends, {.goal = kShares.back() * value});
    std::vector<std::size_t> counts;
    for (const double share : kShares) {
      const auto reached =
          std::ranges::find_if(picks, [&](const ClairvoyantPick& pick) { return pick.connectivity >= share * value; });
      const bool is_there = connectivity(edges, 0) >= share * value;
      counts.push_back(is_there ? 0 : static_cast<std::size_t>(reached - picks.begin()) + 1);
    }
    return counts;
  }
  std::size_t size() const { return vertices_.size(); }

 private:
  static constexpr std::uint32_t kOutside = 0xFFFFFFFF;
  void add(AppearanceGraph& graph, const Edge& e) const {
    const std::uint32_t u = number_[to_index(e.u)], v = number_[to_index(e.v)];
    if (u != kOutside && v != kOutside) graph.add_edge(VertexId{u}, VertexId{v}, e.weight);
  }
  std::vector<VertexId> vertices_;
  std::vector<std::uint32_t> number_;
  AppearanceGraph base_;
};

// Processor time of this thread: other programs' load does not show.
double seconds_now() {
  timespec time;
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

void measure(const std::string& folder, const std::vector<std::string>& maps, const std::vector<std::string>& methods,
             std::uint32_t min_votes, const std::string& cache, bool is_live) {
  MergeInput input = benchmark_support::load_stored_pair(folder, maps[0], maps[1]);
  if (is_live) {
    input.verifier = make_verifier();
  } else {
    const std::string file =
        cache.empty() ? "" : cache + "/" + std::filesystem::path(folder).filename().string() + ".verdicts";
    input.verifier = std::make_shared<benchmark_support::RememberingVerifier>(make_verifier(), file);
  }
  input.options.min_votes = min_votes;
  const MemberPair pair = order_members(input.members);
  const double index_start = seconds_now();
  input.votes = std::make_shared<WordVotes>(*input.appearances, input.members[pair.m1], input.members[pair.m2]);
  const double index_s = seconds_now() - index_start;
  for (const std::string& method : methods) {
    input.options.method = method;
    const double start = seconds_now();
    const auto merger = make_merger(input);
    double longest = 0, before = seconds_now();
    std::vector<double> times(1, 0.0);  // by number of verifications
    run(*merger, {}, [&](const Merger& m) {
      const double now = seconds_now();
      if (m.state().verifications == times.size()) times.push_back(now - start);
      longest = std::max(longest, now - before);
      before = now;
    });
    const double elapsed = seconds_now() - start;
    std::vector<TimedEdge> edges;
    std::vector<Edge> all = input.inner_edges;
    for (const MergeEdge& e : merger->state().edges) {
      const Edge edge{e.u, e.v, static_cast<std::uint32_t>(e.verification.inliers)};
      edges.push_back({edge, e.verifications});
      all.push_back(edge);
    }
    const FinalComponent component(merger->graph().vertices(), input.inner_edges, all);
    const double final_value = component.connectivity(edges, edges.size());
    if (method == methods.front()) {
      std::printf(
          "%s: %zu + %zu vertices, %llu candidates, %zu edges, final component %zu, lambda_2 %.6g, index %.3f s\n",
          folder.c_str(), input.members[0].vertices.size(), input.members[1].vertices.size(),
          static_cast<unsigned long long>(merger->state().verifications), edges.size(), component.size(), final_value,
          index_s);
      std::printf("  %-14s", "clairvoyant");
      for (const std::size_t count : component.clairvoyant(edges, final_value)) std::printf(" %6zu", count);
      std::printf("   edges\n");
    }
    std::printf("  %-14s", method.c_str());
    for (const double share : kShares) {
      const std::uint64_t count = component.reached(edges, share * final_value);
      std::printf(" %6llu", static_cast<unsigned long long>(count));
      if (is_live) std::printf(" (%.3f s)", times[count]);
    }
    std::printf("   %7.3f s, longest step %.1f ms\n", elapsed, 1e3 * longest);
    std::fflush(stdout);
  }
}

}  // namespace
}  // namespace mapweld

int main(int argc, char** argv) {
  CLI::App app("Verifications to 50, 90, 95, 96 and 99 % of the final lambda_2, by method; edges of the clairvoyant.");
  std::vector<std::string> folders, maps{"robot-a", "robot-b"}, methods{"quickconnect", "brute-force", "spectral"};
  std::uint32_t min_votes = mapweld::MergeOptions{}.min_votes;
  std::string cache;
  bool is_live = false;
  app.add_option("folders", folders, "data folders, each with the two maps")->required();
  app.add_option("--maps", maps, "names of the two maps")->expected(2);
  app.add_option("--methods", methods, "methods to run");
  app.add_option("--min-votes", min_votes);
  app.add_option("--cache", cache, "folder that keeps verdicts from run to run");
  app.add_flag("--live", is_live, "verify anew for each method, so that times are true ones");
  CLI11_PARSE(app, argc, argv);
  for (const std::string& folder : folders) mapweld::measure(folder, maps, methods, min_votes, cache, is_live);
}
