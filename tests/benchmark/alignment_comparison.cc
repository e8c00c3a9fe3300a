// Merges two stored maps by `alignment` and by every candidate there is, and sets the outcomes side by side:
// docs/alignment.md.
//   alignment_comparison --data FOLDER --maps A B [--pairs pairs.csv | --same-place same_place.csv | --frame-order N]
// FOLDER is a data folder that no server has open.
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <exception>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>

#include "core/geometry/epipolar_verifier.h"
#include "core/graph/algebraic_connectivity.h"
#include "core/merge/make_merger.h"
#include "core/merge/merge_metrics.h"
#include "core/merge/methods/alignment.h"
#include "core/merge/run.h"
#include "core/merge/vote_source.h"
#include "schema/maps/edge_store.h"
#include "schema/maps/map_layout.h"
#include "schema/maps/map_store.h"
#include "schema/maps/vertex_store.h"
#include "schema/store.h"

namespace {

using namespace mapweld;  // NOLINT
struct StoredPair {
  MergeInput input;
  std::vector<std::string> names;  // by merged vertex
};

// A verdict is a pure function of the pair: the second method to ask gets it from here. Times are not compared.
class RememberingVerifier final : public PairVerifier {
 public:
  Verification verify(const AppearanceVector& a, const AppearanceVector& b) const override {
    const auto [found, is_new] = known_.try_emplace({&a, &b});
    if (is_new) found->second = verifier_.verify(a, b);
    return found->second;
  }
  std::string version() const override { return verifier_.version(); }
  const VerifierOptions& options() const override { return verifier_.options(); }

 private:
  EpipolarVerifier verifier_;
  mutable std::map<std::pair<const AppearanceVector*, const AppearanceVector*>, Verification> known_;
};

StoredPair load(const std::string& folder, const std::vector<std::string>& maps, std::uint32_t min_votes) {
  Store store(std::filesystem::path(folder) / "mapweld.db");
  const ReadTransaction db = store.read();
  StoredPair result;
  std::vector<std::uint32_t> sizes;
  std::vector<std::shared_ptr<const AppearanceVector>> vectors;
  for (const std::string& name : maps) {
    const std::optional<MapRow> map = find_map(db, name);
    if (!map) throw std::runtime_error("there is no map " + name);
    const auto first = static_cast<std::uint32_t>(vectors.size());
    for (AppearanceVector& v : load_appearances(db, map->id, map->vocabulary, VertexId{0}, map->vertices)) {
      vectors.push_back(std::make_shared<const AppearanceVector>(std::move(v)));
    }
    const MapLayout layout = load_layout(db, map->id);
    for (const Edge& e : load_edges(db, layout)) {
      result.input.inner_edges.push_back({VertexId{to_index(e.u) + first}, VertexId{to_index(e.v) + first}, e.weight});
    }
    for (const VertexRow& row : list_vertices(db, layout, map->vertices)) result.names.push_back(row.image.name);
    sizes.push_back(map->vertices);
  }
  result.input.members = number_members(sizes);
  result.input.appearances = std::make_shared<AppearanceTable>(std::move(vectors));
  result.input.verifier = std::make_shared<RememberingVerifier>();
  result.input.options = {"brute-force", min_votes, VoteRule::kMin, 0};
  const MemberPair pair = order_members(result.input.members);
  result.input.votes = std::make_shared<WordVotes>(*result.input.appearances, result.input.members[pair.m1],
                                                   result.input.members[pair.m2]);
  return result;
}

// What is right: pairs (vertex of the first map, vertex of the second).
struct Truth {
  enum class Kind { kNone, kListed, kOrder } kind = Kind::kNone;
  std::set<std::pair<std::uint32_t, std::uint32_t>> right;
  std::int64_t tolerance = 0;
  std::vector<std::int64_t> expected;  // kOrder: of each vertex of the first map

  bool is_right(std::uint32_t a, std::uint32_t b) const {
    if (kind == Kind::kNone) return true;
    if (kind == Kind::kListed) return right.contains({a, b});
    return std::abs(expected[a] - static_cast<std::int64_t>(b)) <= tolerance;
  }
};

std::vector<std::vector<std::string>> read_csv(const std::string& path) {
  std::ifstream file(path);
  if (!file) throw std::runtime_error("cannot read " + path);
  std::vector<std::vector<std::string>> rows;
  for (std::string line; std::getline(file, line);) {
    std::istringstream cells(line);
    rows.emplace_back();
    for (std::string cell; std::getline(cells, cell, ',');) rows.back().push_back(cell);
  }
  rows.erase(rows.begin());
  return rows;
}

// Pairs (name in the first map, name in the second) become vertices, each widened by so many images on either side.
Truth listed(const StoredPair& maps, const std::vector<std::pair<std::string, std::string>>& pairs, int widen) {
  const auto sizes = std::pair(maps.input.members[0].vertices.size(), maps.input.members[1].vertices.size());
  std::map<std::string, std::int64_t> first, second;
  for (std::size_t i = 0; i < sizes.first; ++i) first[maps.names[i]] = static_cast<std::int64_t>(i);
  for (std::size_t i = 0; i < sizes.second; ++i) second[maps.names[sizes.first + i]] = static_cast<std::int64_t>(i);
  Truth truth;
  truth.kind = Truth::Kind::kListed;
  for (const auto& [a, b] : pairs) {
    const auto at = first.find(a), bt = second.find(b);
    if (at == first.end() || bt == second.end()) continue;
    for (int da = -widen; da <= widen; ++da) {
      for (int db = -widen; db <= widen; ++db) {
        truth.right.emplace(static_cast<std::uint32_t>(at->second + da), static_cast<std::uint32_t>(bt->second + db));
      }
    }
  }
  return truth;
}

std::pair<std::uint32_t, std::uint32_t> own_numbers(const StoredPair& maps, const MergeEdge& e) {
  return {to_index(e.u), to_index(e.v) - static_cast<std::uint32_t>(maps.input.members[0].vertices.size())};
}

// The edges of all candidates say where each image of the first map lies in the second: the median of the edges at it
// and at two images on either side.
Truth frame_order(const StoredPair& maps, const MergeState& brute, std::int64_t tolerance) {
  std::vector<std::vector<std::int64_t>> matches(maps.input.members[0].vertices.size());
  for (const MergeEdge& e : brute.edges) {
    const auto [a, b] = own_numbers(maps, e);
    matches[a].push_back(b);
  }
  Truth truth;
  truth.kind = Truth::Kind::kOrder;
  truth.tolerance = tolerance;
  for (std::size_t a = 0; a < matches.size(); ++a) {
    std::vector<std::int64_t> near;
    for (std::size_t other = a - std::min<std::size_t>(a, 2); other < std::min(matches.size(), a + 3); ++other) {
      near.insert(near.end(), matches[other].begin(), matches[other].end());
    }
    std::sort(near.begin(), near.end());
    truth.expected.push_back(near.empty() ? -1000000 : near[near.size() / 2]);
  }
  return truth;
}

// Verifications until lambda_2 on `component`, with the first edges, is the share of `maximum`; 0: never. It only grows
// with edges, so the edge is found by halving.
class Curve {
 public:
  Curve(const MergeInput& input, const std::vector<VertexId>& component, const MergeState& state)
      : position_(input.members[0].vertices.size() + input.members[1].vertices.size(), kOutside), state_(&state) {
    for (std::uint32_t i = 0; i < component.size(); ++i) position_[to_index(component[i])] = i;
    size_ = static_cast<std::uint32_t>(component.size());
    inner_ = input.inner_edges;
  }
  double value(std::size_t edges) const {
    AppearanceGraph graph(size_);
    const auto add = [&](VertexId u, VertexId v) {
      const std::uint32_t a = position_[to_index(u)], b = position_[to_index(v)];
      if (a != kOutside && b != kOutside) graph.add_edge(VertexId{a}, VertexId{b}, 1);
    };
    for (const Edge& e : inner_) add(e.u, e.v);
    for (std::size_t i = 0; i < edges; ++i) add(state_->edges[i].u, state_->edges[i].v);
    return algebraic_connectivity(graph).value;
  }
  std::uint64_t verifications_to(double level) const {
    std::size_t low = 0, high = state_->edges.size();
    if (value(high) < level * (1 - 1e-9)) return 0;
    while (low < high) {
      const std::size_t middle = (low + high) / 2;
      if (value(middle) >= level * (1 - 1e-9)) {
        high = middle;
      } else {
        low = middle + 1;
      }
    }
    return low == 0 ? 0 : state_->edges[low - 1].verifications;
  }

 private:
  static constexpr std::uint32_t kOutside = 0xFFFFFFFF;
  std::vector<std::uint32_t> position_;
  std::vector<Edge> inner_;
  const MergeState* state_;
  std::uint32_t size_ = 0;
};

struct Outcome {
  std::string name;
  MergeState state;
  MergeMetrics metrics;
  double voting_ms = 0;        // processor time: everything before the first verification
  double longest_step_ms = 0;  // of those
};

Outcome merge(const std::string& name, Merger& merger) {
  Outcome outcome;
  outcome.name = name;
  while (!merger.done() && merger.state().phase == MergePhase::kVoting) {
    const std::clock_t start = std::clock();
    merger.step();
    const double ms = 1e3 * static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
    outcome.voting_ms += ms;
    outcome.longest_step_ms = std::max(outcome.longest_step_ms, ms);
  }
  run(merger, {});
  outcome.metrics = merge_metrics(merger.graph(), merger.input().members, merger.state().edges);
  outcome.state = merger.state();
  return outcome;
}

int compare(int argc, char** argv) {
  CLI::App app{"Compares merging by alignment with every candidate's verdict.", "alignment_comparison"};
  std::string folder, pairs_csv, same_place_csv;
  std::vector<std::string> names;
  std::uint32_t min_votes = 10;
  std::int64_t order_tolerance = 0;
  Alignment::Limits limits;
  app.add_option("--data", folder, "a data folder, not in use")->required();
  app.add_option("--maps", names, "two maps")->required()->expected(2);
  app.add_option("--pairs", pairs_csv, "truth: pairs.csv of render-sample-world; right from a shared view of 0.1");
  app.add_option("--same-place", same_place_csv, "truth: name in the second map, name in the first; widened by one");
  app.add_option("--frame-order", order_tolerance, "truth: so many images from the median of the other edges nearby");
  app.add_option("--min-votes", min_votes);
  app.add_option("--level-percent", limits.level_percent);
  app.add_option("--min-images", limits.min_images);
  app.add_option("--halo", limits.halo);
  app.add_option("--min-score", limits.sequence.min_score);
  app.add_option("--max-step", limits.sequence.max_step);
  app.add_option("--skip-penalty", limits.sequence.skip_penalty);
  app.add_option("--repeat-penalty", limits.sequence.repeat_penalty);
  app.get_formatter()->column_width(32);
  for (CLI::Option* option : app.get_options()) option->capture_default_str();
  CLI11_PARSE(app, argc, argv);

  const StoredPair maps = load(folder, names, min_votes);
  std::vector<Outcome> outcomes;
  for (const char* method : {"brute-force", "quickconnect"}) {
    MergeInput input = maps.input;
    input.options.method = method;
    outcomes.push_back(merge(method, *make_merger(std::move(input))));
  }
  MergeInput input = maps.input;
  input.options.method = Alignment::kName;
  Alignment alignment(std::move(input), limits);
  outcomes.push_back(merge("alignment", alignment));

  Truth truth;
  if (!pairs_csv.empty()) {
    std::vector<std::pair<std::string, std::string>> right;
    for (const auto& row : read_csv(pairs_csv)) {
      if (std::stod(row.at(2)) >= 0.1) right.emplace_back(row.at(0), row.at(1));
    }
    truth = listed(maps, right, 0);
  } else if (!same_place_csv.empty()) {
    std::vector<std::pair<std::string, std::string>> right;
    for (const auto& row : read_csv(same_place_csv)) right.emplace_back(row.at(1), row.at(0));
    truth = listed(maps, right, 1);
  } else if (order_tolerance > 0) {
    truth = frame_order(maps, outcomes[0].state, order_tolerance);
  }

  const auto largest_of = [&](const MergeState& state) {
    AppearanceGraph graph(static_cast<std::uint32_t>(maps.names.size()), maps.input.inner_edges);
    for (const MergeEdge& e : state.edges) graph.add_edge(e.u, e.v, 1);
    return largest_component_connectivity(graph);
  };
  // Everybody is judged on what alignment joins, by the value that alignment ends with: what it leaves out has 0.
  const std::vector<VertexId> joined = largest_of(outcomes[2].state).vertices;
  const double maximum = Curve(maps.input, joined, outcomes[2].state).value(outcomes[2].state.edges.size());
  std::printf("%zu + %zu images; largest component of all %zu, of alignment %zu, there lambda2 %.6g\n",
              maps.input.members[0].vertices.size(), maps.input.members[1].vertices.size(),
              largest_of(outcomes[0].state).vertices.size(), joined.size(), maximum);
  std::printf("%-13s %8s %6s %6s %6s %9s %7s %8s | %7s %7s %7s | %8s %8s\n", "method", "verified", "edges", "right",
              "wrong", "joined", "joins", "lambda2", "to 90%", "95%", "99%", "vote ms", "step ms");
  for (const Outcome& o : outcomes) {
    std::size_t wrong = 0;
    for (const MergeEdge& e : o.state.edges) {
      const auto [a, b] = own_numbers(maps, e);
      wrong += truth.is_right(a, b) ? 0 : 1;
    }
    const Curve curve(maps.input, joined, o.state);
    const auto to = [&](double share) {
      const std::uint64_t v = curve.verifications_to(maximum * share);
      return v == 0 ? std::string("-") : std::to_string(v);
    };
    std::printf("%-13s %8llu %6zu %6zu %6zu %4u/%4u %7u %7.1f%% | %7s %7s %7s | %8.1f %8.2f\n", o.name.c_str(),
                static_cast<unsigned long long>(o.state.verifications), o.state.edges.size(),
                o.state.edges.size() - wrong, wrong, o.metrics.joined[0], o.metrics.joined[1],
                o.metrics.independent_joins, 100 * curve.value(o.state.edges.size()) / maximum, to(0.9).c_str(),
                to(0.95).c_str(), to(0.99).c_str(), o.voting_ms, o.longest_step_ms);
  }
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return compare(argc, argv);
  } catch (const std::exception& error) {
    std::cerr << "alignment_comparison: " << error.what() << "\n";
    return 1;
  }
}
