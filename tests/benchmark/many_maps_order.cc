// What a merge of many maps has joined after so many verifications, by method; docs/spectral.md holds the figures.
#include <algorithm>
#include <cstdio>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "core/geometry/epipolar_verifier.h"
#include "core/graph/algebraic_connectivity.h"
#include "core/graph/components.h"
#include "core/graph/disjoint_sets.h"
#include "core/merge/make_merger.h"
#include "core/merge/run.h"
#include "tests/benchmark/stored_pair.h"

namespace mapweld {
namespace {

struct Joined {
  std::uint32_t vertices = 0;  // in the largest component
  std::size_t members = 0;     // that edges join, directly or by others
  std::size_t pairs = 0;       // of members with an edge between them
  double connectivity = 0;     // of the largest component
  double final_share = 0;      // lambda_2 on the vertices of the finished merge's largest component, of its final value
};

class Merge {
 public:
  explicit Merge(MergeInput input) : input_(std::move(input)), member_of_(vertices()) {
    for (std::uint32_t k = 0; k < input_.members.size(); ++k) {
      for (const VertexId v : input_.members[k].vertices) member_of_[to_index(v)] = k;
    }
    final_ = edges_after("brute-force", UINT64_MAX);
    const Components components = connected_components(graph(final_));
    final_vertices_ = components.vertices_of(components.largest());
    final_value_ = on_final(final_);
  }
  std::size_t final_edges() const { return final_.size(); }
  std::size_t pairs() const { return all_member_pairs(input_.members).size(); }
  Joined final_joined() const { return joined(final_); }

  Joined after(const std::string& method, std::uint64_t verifications, std::uint64_t seed) {
    input_.options.seed = seed;
    return joined(edges_after(method, verifications));
  }
  // The budget shared equally among the pairs, each by itself.
  Joined after_shares(const std::string& method, std::uint64_t verifications) {
    std::vector<Edge> edges;
    for (const MemberPair& pair : all_member_pairs(input_.members)) {
      const auto i = std::min(pair.m1, pair.m2), j = std::max(pair.m1, pair.m2);
      const std::vector<Edge> found = edges_of_pair(method, verifications / pairs(), i, j);
      edges.insert(edges.end(), found.begin(), found.end());
    }
    return joined(edges);
  }

 private:
  std::uint32_t vertices() const {
    std::size_t n = 0;
    for (const MergeMember& m : input_.members) n += m.vertices.size();
    return static_cast<std::uint32_t>(n);
  }
  std::vector<Edge> edges_after(const std::string& method, std::uint64_t verifications) const {
    MergeInput input = input_;
    input.options.method = method;
    const auto merger = make_merger(input);
    run(*merger, stop_at_verifications(verifications));
    std::vector<Edge> edges;
    for (const MergeEdge& e : merger->state().edges) {
      edges.push_back({e.u, e.v, static_cast<std::uint32_t>(e.verification.inliers)});
    }
    return edges;
  }
  // Members i and j alone.
  std::vector<Edge> edges_of_pair(const std::string& method, std::uint64_t verifications, std::size_t i,
                                  std::size_t j) const {
    MergeInput input = input_;
    std::vector<VertexId> all = input_.members[i].vertices;
    all.insert(all.end(), input_.members[j].vertices.begin(), input_.members[j].vertices.end());
    std::vector<std::uint32_t> number(member_of_.size(), UINT32_MAX);
    std::vector<std::shared_ptr<const AppearanceVector>> vectors;
    for (std::uint32_t k = 0; k < all.size(); ++k) {
      number[to_index(all[k])] = k;
      vectors.push_back(input_.appearances->appearances(all[k]));
    }
    input.members = number_members({static_cast<std::uint32_t>(input_.members[i].vertices.size()),
                                    static_cast<std::uint32_t>(input_.members[j].vertices.size())});
    input.appearances = std::make_shared<AppearanceTable>(std::move(vectors));
    input.inner_edges.clear();
    for (const Edge& e : input_.inner_edges) {
      const std::uint32_t u = number[to_index(e.u)], v = number[to_index(e.v)];
      if (u != UINT32_MAX && v != UINT32_MAX) input.inner_edges.push_back({VertexId{u}, VertexId{v}, e.weight});
    }
    input.options.method = method;
    const auto merger = make_merger(input);
    run(*merger, stop_at_verifications(verifications));
    std::vector<Edge> edges;
    for (const MergeEdge& e : merger->state().edges) {
      edges.push_back({all[to_index(e.u)], all[to_index(e.v)], static_cast<std::uint32_t>(e.verification.inliers)});
    }
    return edges;
  }
  AppearanceGraph graph(const std::vector<Edge>& edges) const {
    AppearanceGraph graph(vertices(), input_.inner_edges);
    for (const Edge& e : edges) graph.add_edge(e.u, e.v, e.weight);
    return graph;
  }
  double on_final(const std::vector<Edge>& edges) const {
    return algebraic_connectivity(induced_subgraph(graph(edges), final_vertices_)).value;
  }
  Joined joined(const std::vector<Edge>& edges) const {
    const AppearanceGraph whole = graph(edges);
    const Components components = connected_components(whole);
    const std::vector<VertexId> largest = components.vertices_of(components.largest());
    std::vector<bool> has_edge(pairs(), false);
    DisjointSets members(static_cast<std::uint32_t>(input_.members.size()));
    for (const Edge& e : edges) {
      const std::uint32_t i = member_of_[to_index(e.u)], j = member_of_[to_index(e.v)];
      has_edge[place_of_pair(i, j, input_.members.size())] = true;
      members.join(i, j);
    }
    Joined result;
    result.vertices = static_cast<std::uint32_t>(largest.size());
    for (std::uint32_t k = 0; k < input_.members.size(); ++k) {
      result.members = std::max<std::size_t>(result.members, members.size_of(k));
    }
    result.pairs = static_cast<std::size_t>(std::ranges::count(has_edge, true));
    result.connectivity = algebraic_connectivity(induced_subgraph(whole, largest)).value;
    result.final_share = final_value_ > 0 ? on_final(edges) / final_value_ : 0;
    return result;
  }

  MergeInput input_;
  std::vector<std::uint32_t> member_of_;
  std::vector<Edge> final_;
  std::vector<VertexId> final_vertices_;
  double final_value_ = 0;
};

void print(const std::string& what, const Joined& j, std::size_t pairs) {
  std::printf("  %-22s %5u vertices, %zu members, %zu of %zu pairs, lambda_2 %.4g, %5.1f %% of the final one\n",
              what.c_str(), j.vertices, j.members, j.pairs, pairs, j.connectivity, 100 * j.final_share);
  std::fflush(stdout);
}

}  // namespace
}  // namespace mapweld

int main(int argc, char** argv) {
  CLI::App app("What a merge of many maps has joined after so many verifications, by method.");
  std::string folder, cache;
  std::vector<std::string> maps, methods{"spectral", "quickconnect", "brute-force", "random-candidates"};
  std::vector<std::uint64_t> budgets{100, 300, 1000};
  std::uint64_t seeds = 3;
  app.add_option("folder", folder, "data folder")->required();
  app.add_option("--maps", maps, "their names")->required()->expected(2, 1000);
  app.add_option("--methods", methods, "methods to run");
  app.add_option("--verifications", budgets, "budgets");
  app.add_option("--seeds", seeds, "of methods that draw at random");
  app.add_option("--cache", cache, "file that keeps verdicts from run to run");
  CLI11_PARSE(app, argc, argv);
  using namespace mapweld;
  MergeInput input = benchmark_support::load_stored_maps(folder, maps);
  input.verifier = std::make_shared<benchmark_support::RememberingVerifier>(make_verifier(), cache);
  Merge merge(std::move(input));
  print("finished", merge.final_joined(), merge.pairs());
  for (const std::uint64_t budget : budgets) {
    std::printf("after %llu verifications\n", static_cast<unsigned long long>(budget));
    for (const std::string& method : methods) {
      for (std::uint64_t seed = 0; seed < (is_randomised(method) ? seeds : 1); ++seed) {
        print(method, merge.after(method, budget, seed), merge.pairs());
      }
    }
    print("spectral, shared", merge.after_shares("spectral", budget), merge.pairs());
  }
}
