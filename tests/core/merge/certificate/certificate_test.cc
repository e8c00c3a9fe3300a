#include "core/merge/certificate/certificate.h"

#include <algorithm>
#include <map>
#include <numeric>
#include <optional>
#include <random>
#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>

#include "core/graph/components.h"
#include "tests/core/graph/laplacian_oracle.h"
#include "tests/core/graph/sample_graphs.h"

namespace mapweld {
namespace {

VertexId vertex(std::uint32_t v) { return VertexId{v}; }

// Points in the unit square, near ones joined.
AppearanceGraph random_geometric(std::uint32_t n, double radius, std::uint32_t seed) {
  std::mt19937 random(seed);
  std::vector<std::pair<double, double>> points(n);
  for (auto& [x, y] : points) {
    x = static_cast<double>(random() % 10000) / 10000;
    y = static_cast<double>(random() % 10000) / 10000;
  }
  AppearanceGraph graph(n);
  for (std::uint32_t u = 0; u < n; ++u) {
    for (std::uint32_t v = u + 1; v < n; ++v) {
      const double dx = points[u].first - points[v].first, dy = points[u].second - points[v].second;
      if (dx * dx + dy * dy < radius * radius) graph.add_edge(vertex(u), vertex(v), 1);
    }
  }
  return graph;
}

// Two walks of n vertices and a few images without an edge; `joins` edges between the walks.
AppearanceGraph two_walks(std::uint32_t n, std::uint32_t joins, std::uint32_t seed) {
  std::mt19937 random(seed);
  AppearanceGraph graph(2 * n + 3);
  for (const std::uint32_t first : {0u, n}) {
    for (std::uint32_t v = 1; v < n; ++v) {
      graph.add_edge(vertex(first + v), vertex(first + v - 1), 1);
      if (v > 2 && random() % 2 == 0) graph.add_edge(vertex(first + v), vertex(first + v - 3), 1);
    }
  }
  for (std::uint32_t k = 0; k < joins; ++k) graph.add_edge(vertex(random() % n), vertex(n + random() % n), 1);
  return graph;
}

struct Case {
  AppearanceGraph graph;
  std::vector<OpenCandidate> open;
};

Case random_case(std::uint32_t seed) {
  std::mt19937 random(1000 + seed);
  const std::uint32_t size = 2 + random() % 60;
  Case result;
  switch (seed % 6) {
    case 0:
      result.graph = test::path(size);
      break;
    case 1:
      result.graph = test::grid(2 + size % 8, 1 + size / 8);
      break;
    case 2:
      result.graph = random_geometric(size, 0.2, seed);
      break;
    case 3:
      result.graph = two_walks(size, 1 + size / 10, seed);
      break;
    case 4:
      result.graph = two_walks(size, 0, seed);
      break;
    default:
      result.graph = test::random_map(size, 2, 0.1, seed);
  }
  const std::uint32_t n = result.graph.vertices();
  const std::uint32_t count = random() % (3 * n);
  for (std::uint32_t k = 0; k < count; ++k) {
    const std::uint32_t u = random() % n;
    const std::uint32_t v = random() % 3 == 0 ? std::min(u + 1 + static_cast<std::uint32_t>(random() % 5), n - 1)
                                              : static_cast<std::uint32_t>(random() % n);
    if (u == v) continue;
    result.open.push_back({vertex(u), vertex(v), static_cast<double>(random() % 101) / 100});
  }
  return result;
}

// Everything below in dense arithmetic on the fixed vertices K of the graph as it is now.
std::vector<VertexId> largest_now(const AppearanceGraph& graph) {
  const Components components = connected_components(graph);
  return components.vertices_of(components.largest());
}

double dense_on(const std::vector<VertexId>& k, const AppearanceGraph& graph) {
  const AppearanceGraph induced = induced_subgraph(graph, k);
  return test::dense_connectivity(static_cast<int>(k.size()), test::unit_edges(induced));
}

AppearanceGraph with(AppearanceGraph graph, const std::vector<OpenCandidate>& accepted) {
  for (const OpenCandidate& c : accepted) graph.add_edge(c.u, c.v, 1);
  return graph;
}

std::optional<double> dense_fraction(const AppearanceGraph& now, const AppearanceGraph& later) {
  const std::vector<VertexId> k = largest_now(now);
  if (k.size() < 2) return std::nullopt;
  return dense_on(k, now) / dense_on(k, later);
}

// Dense values are exact to about 1e-14 of the greatest degree; paths of 60 have lambda_2 of 3e-3.
constexpr double kDenseError = 1e-10;

TEST(Certificate, NeverExceedsTheTrueFraction) {
  int tight = 0, disconnected = 0, checked = 0;
  for (std::uint32_t seed = 0; seed < 400; ++seed) {
    const Case c = random_case(seed);
    std::mt19937 random(seed);
    const Certificate result = certify(c.graph, c.open);
    CertificateOptions hurried;
    hurried.iteration.max_iterations = 1 + static_cast<int>(seed % 4);
    const Certificate rough = certify(c.graph, c.open, hurried);
    EXPECT_LE(result.certified_fraction, 1.0);
    EXPECT_GT(result.certified_fraction, 0.0);
    if (connected_components(c.graph).count() > 1) ++disconnected;
    for (int subset = 0; subset < 6; ++subset) {
      std::vector<OpenCandidate> accepted;
      for (const OpenCandidate& o : c.open) {
        const bool passes = subset == 0 || (subset == 1 && o.chance >= 0.5) ||
                            (subset > 1 && random() % 6 < static_cast<unsigned>(subset));
        if (passes) accepted.push_back(o);
      }
      const std::optional<double> truth = dense_fraction(c.graph, with(c.graph, accepted));
      if (!truth) continue;
      ++checked;
      EXPECT_LE(result.certified_fraction, *truth * (1 + kDenseError)) << "seed " << seed << " subset " << subset;
      EXPECT_LE(rough.certified_fraction, *truth * (1 + kDenseError)) << "seed " << seed << " subset " << subset;
      if (subset == 0) {
        EXPECT_TRUE(result.converged);
        EXPECT_GE(result.certified_fraction, *truth * 0.98) << "seed " << seed;
        if (result.certified_fraction >= *truth * (1 - 1e-3)) ++tight;
      }
    }
  }
  EXPECT_GT(checked, 2000);
  EXPECT_GT(tight, 350);
  EXPECT_GT(disconnected, 100);
}

TEST(Certificate, EqualsTheDefinitionWhenAskedToConverge) {
  CertificateOptions options;
  options.iteration.least_progress = 0;
  options.iteration.max_iterations = 500;
  for (std::uint32_t seed = 0; seed < 200; ++seed) {
    const Case c = random_case(seed);
    const std::optional<double> truth = dense_fraction(c.graph, with(c.graph, c.open));
    if (!truth) continue;
    const Certificate result = certify(c.graph, c.open, options);
    EXPECT_TRUE(result.converged);
    EXPECT_NEAR(result.certified_fraction, *truth, 1e-6 * *truth) << "seed " << seed;
  }
}

// Sizes at which the whole space is not in reach of the basis, with many more candidates than edges.
TEST(Certificate, HoldsWithManyLongRangeCandidates) {
  for (std::uint32_t seed = 0; seed < 6; ++seed) {
    const std::uint32_t n = 150;
    Case c{two_walks(n, seed % 3, seed), {}};
    std::mt19937 random(seed);
    for (std::uint32_t k = 0; k < 2500; ++k) {
      c.open.push_back({vertex(random() % n), vertex(n + random() % n), seed < 3 ? 0.02 : 0.5});
    }
    for (std::uint32_t k = 0; k < 200; ++k) {
      const std::uint32_t u = random() % n, v = random() % n;
      if (u != v) c.open.push_back({vertex(u), vertex(v), 0.01});
    }
    const double truth = *dense_fraction(c.graph, with(c.graph, c.open));
    const Certificate result = certify(c.graph, c.open);
    EXPECT_LE(result.certified_fraction, truth * (1 + kDenseError));
    EXPECT_GE(result.certified_fraction, truth * 0.95);
  }
}

// A merge in a random order: what the certificate said on the way against how it ended.
TEST(Certificate, IsBorneOutByTheFinishedMerge) {
  for (std::uint32_t seed = 0; seed < 100; ++seed) {
    const Case c = random_case(seed);
    std::mt19937 random(seed);
    std::vector<OpenCandidate> order = c.open;
    std::ranges::shuffle(order, random);
    std::vector<bool> passes;
    for (const OpenCandidate& o : order) passes.push_back(static_cast<double>(random() % 100) / 100 < o.chance);
    AppearanceGraph end = c.graph;
    for (std::size_t k = 0; k < order.size(); ++k) {
      if (passes[k]) end.add_edge(order[k].u, order[k].v, 1);
    }
    AppearanceGraph now = c.graph;
    for (std::size_t k = 0; k <= order.size(); ++k) {
      if (k % 11 == 0 || k == order.size()) {
        const Certificate result = certify(now, std::span(order).subspan(k));
        if (const auto truth = dense_fraction(now, end)) {
          EXPECT_LE(result.certified_fraction, *truth * (1 + kDenseError)) << "seed " << seed << " after " << k;
        }
        // The final component of K is K and some of the vertices that could join.
        const Components last = connected_components(end);
        const std::uint32_t size = last.sizes[last.component_of[to_index(largest_now(now).front())]];
        EXPECT_LE(size, result.vertices + result.joinable_vertices);
        if (k == order.size()) {
          EXPECT_EQ(result.certified_fraction, 1.0);
          EXPECT_EQ(result.joinable_vertices, 0u);
        }
      }
      if (k < order.size() && passes[k]) now.add_edge(order[k].u, order[k].v, 1);
    }
  }
}

TEST(Certificate, CountsJoinableVerticesAsUnionFindDoes) {
  std::uint32_t seen = 0;
  for (std::uint32_t seed = 0; seed < 300; ++seed) {
    const Case c = random_case(seed);
    std::vector<std::uint32_t> label(c.graph.vertices());
    std::iota(label.begin(), label.end(), 0u);
    const auto join = [&label](VertexId u, VertexId v) {
      const std::uint32_t from = label[to_index(u)], to = label[to_index(v)];
      for (std::uint32_t& l : label) l = l == from ? to : l;
    };
    for (const Edge& e : c.graph.edge_list()) join(e.u, e.v);
    for (const OpenCandidate& o : c.open) join(o.u, o.v);
    const std::vector<VertexId> k = largest_now(c.graph);
    const auto reached = static_cast<std::uint32_t>(std::ranges::count(label, label[to_index(k.front())]));
    const Certificate result = certify(c.graph, c.open);
    std::uint32_t rivals = 0;
    std::map<std::uint32_t, std::vector<std::uint32_t>> classes;
    for (std::uint32_t v = 0; v < label.size(); ++v) classes[label[v]].push_back(v);
    for (const auto& [l, members] : classes) {
      const bool outgrows =
          members.size() > k.size() || (members.size() == k.size() && members.front() < to_index(k.front()));
      if (l != label[to_index(k.front())] && outgrows) rivals += static_cast<std::uint32_t>(members.size());
    }
    EXPECT_EQ(result.joinable_vertices, reached - k.size() + rivals) << "seed " << seed;
    seen += result.joinable_vertices > 0 ? 1 : 0;
  }
  EXPECT_GT(seen, 80u);
}

// A clique of 5 and two of 4: nothing can join the largest, and yet it may not stay the largest.
TEST(Certificate, CountsTheVerticesOfAComponentThatMayOutgrowTheLargest) {
  AppearanceGraph graph(13);
  for (const auto& [first, end] : {std::pair{0u, 5u}, {5u, 9u}, {9u, 13u}}) {
    for (std::uint32_t u = first; u < end; ++u) {
      for (std::uint32_t v = u + 1; v < end; ++v) graph.add_edge(vertex(u), vertex(v), 1);
    }
  }
  const Certificate result = certify(graph, std::vector<OpenCandidate>{{vertex(6), vertex(10), 0.5}});
  EXPECT_EQ(result.vertices, 5u);
  EXPECT_EQ(result.open_within, 0u);
  EXPECT_EQ(result.joinable_vertices, 8u);
  // One that stays smaller, and one that comes to be as large: of equal ones that with the lowest vertex is the
  // largest.
  AppearanceGraph walks(9);  // 0 1 | 2 3 4 | 5 6 | 7 | 8
  for (const auto& [u, v] : {std::pair{0u, 1u}, {2u, 3u}, {3u, 4u}, {5u, 6u}}) walks.add_edge(vertex(u), vertex(v), 1);
  EXPECT_EQ(certify(walks, std::vector<OpenCandidate>{{vertex(7), vertex(8), 1}}).joinable_vertices, 0u);
  EXPECT_EQ(certify(walks, std::vector<OpenCandidate>{{vertex(5), vertex(8), 1}}).joinable_vertices, 0u);
  EXPECT_EQ(certify(walks, std::vector<OpenCandidate>{{vertex(1), vertex(8), 1}}).joinable_vertices, 3u);
}

TEST(Certificate, IsOneWhenNothingCanBeAddedWithinTheLargestComponent) {
  EXPECT_EQ(certify(AppearanceGraph(), {}).certified_fraction, 1.0);
  EXPECT_EQ(certify(test::path(30), {}).certified_fraction, 1.0);

  const Certificate single = certify(AppearanceGraph(3), std::vector<OpenCandidate>{{vertex(0), vertex(2), 0.5}});
  EXPECT_EQ(single.vertices, 1u);
  EXPECT_EQ(single.certified_fraction, 1.0);
  EXPECT_EQ(single.joinable_vertices, 1u);

  // A candidate that is an edge already adds nothing.
  const AppearanceGraph path = test::path(30);
  EXPECT_EQ(certify(path, std::vector<OpenCandidate>{{vertex(5), vertex(4), 0.5}}).certified_fraction, 1.0);
  EXPECT_LT(certify(path, std::vector<OpenCandidate>{{vertex(0), vertex(29), 0.5}}).certified_fraction, 0.5);
}

TEST(Certificate, OfAPathThatMayBecomeACycle) {
  CertificateOptions options;
  options.iteration.least_progress = 0;
  const Certificate result = certify(test::path(40), std::vector<OpenCandidate>{{vertex(0), vertex(39), 1.0}}, options);
  const double path = 4 * std::pow(std::sin(3.14159265358979 / 80), 2);
  const double cycle = 4 * std::pow(std::sin(3.14159265358979 / 40), 2);
  EXPECT_NEAR(result.certified_fraction, path / cycle, 1e-8);
}

TEST(Certificate, DoesNotDependOnTheOrderOfCandidates) {
  for (std::uint32_t seed = 0; seed < 40; ++seed) {
    Case c = random_case(seed);
    const Certificate a = certify(c.graph, c.open);
    std::mt19937 random(seed);
    std::ranges::shuffle(c.open, random);
    for (OpenCandidate& o : c.open) std::swap(o.u, o.v);
    c.open.insert(c.open.end(), c.open.begin(), c.open.end());
    const Certificate b = certify(c.graph, c.open);
    EXPECT_EQ(a.certified_fraction, b.certified_fraction);
    EXPECT_EQ(a.open_within, b.open_within);
    EXPECT_EQ(a.iterations, b.iterations);
    const Certificate known = certify(c.graph, largest_component_connectivity(c.graph), c.open);
    EXPECT_EQ(a.certified_fraction, known.certified_fraction);
  }
}

TEST(Certificate, RefusesWhatIsNoCandidate) {
  const AppearanceGraph graph = test::path(5);
  EXPECT_THROW(certify(graph, std::vector<OpenCandidate>{{vertex(1), vertex(1), 0.5}}), std::invalid_argument);
  EXPECT_THROW(certify(graph, std::vector<OpenCandidate>{{vertex(1), vertex(5), 0.5}}), std::invalid_argument);
}

}  // namespace
}  // namespace mapweld
