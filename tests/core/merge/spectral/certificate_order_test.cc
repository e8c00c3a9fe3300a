#include "core/merge/spectral/certificate_order.h"

#include <algorithm>
#include <cstdint>
#include <random>
#include <set>
#include <utility>
#include <vector>

#include <Eigen/Eigenvalues>
#include <gtest/gtest.h>

#include "core/graph/components.h"
#include "core/merge/certificate/certificate.h"
#include "core/merge/make_merger.h"
#include "core/merge/run.h"
#include "tests/core/merge/toy_maps.h"
#include "tests/core/merge/verdict_log.h"

namespace mapweld {
namespace {

using Ends = std::pair<VertexId, VertexId>;

// Two walks with few joins, and a third that nothing joins yet.
struct Walks {
  AppearanceGraph graph{70};
  std::vector<Ends> open;
  explicit Walks(std::uint32_t seed) {
    std::mt19937 random(seed);
    for (const auto& [first, end] : {std::pair{0u, 30u}, std::pair{30u, 55u}, std::pair{55u, 70u}}) {
      for (std::uint32_t v = first + 1; v < end; ++v) graph.add_edge(VertexId{v - 1}, VertexId{v}, 1);
    }
    graph.add_edge(VertexId{3}, VertexId{33}, 1);
    std::set<std::pair<std::uint32_t, std::uint32_t>> seen{{3, 33}};
    while (open.size() < 40) {
      const auto u = static_cast<std::uint32_t>(random() % 30), v = static_cast<std::uint32_t>(30 + random() % 40);
      if (seen.insert({u, v}).second) open.emplace_back(VertexId{u}, VertexId{v});
    }
  }
};

// The Fiedler vector of the first 55 vertices with all open candidates, by a dense solver.
Eigen::VectorXd dense_fiedler(const Walks& walks) {
  Eigen::MatrixXd laplacian = Eigen::MatrixXd::Zero(55, 55);
  const auto add = [&](std::uint32_t u, std::uint32_t v) {
    if (u >= 55 || v >= 55) return;
    laplacian(u, u) += 1;
    laplacian(v, v) += 1;
    laplacian(u, v) -= 1;
    laplacian(v, u) -= 1;
  };
  for (std::uint32_t u = 0; u < 55; ++u) {
    for (const Neighbour& n : walks.graph.neighbours(VertexId{u})) {
      if (u < to_index(n.vertex)) add(u, to_index(n.vertex));
    }
  }
  for (const auto& [u, v] : walks.open) add(to_index(u), to_index(v));
  return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(laplacian).eigenvectors().col(1);
}

TEST(CertificateOrder, BeginsWithWhatTheBoundRestsOn) {
  for (std::uint32_t seed = 0; seed < 20; ++seed) {
    const Walks walks(seed);
    const CertificateOrder order = certificate_order(walks.graph, walks.open, walks.open.size());
    const Eigen::VectorXd w = dense_fiedler(walks);
    const auto gap2 = [&](std::uint32_t i) {
      const double gap = w[to_index(walks.open[i].first)] - w[to_index(walks.open[i].second)];
      return gap * gap;
    };
    std::vector<std::uint32_t> all = order.within;
    all.insert(all.end(), order.joining.begin(), order.joining.end());
    std::ranges::sort(all);
    for (std::uint32_t i = 0; i < all.size(); ++i) EXPECT_EQ(all[i], i) << "each once";
    ASSERT_EQ(all.size(), walks.open.size());
    for (const std::uint32_t i : order.joining) EXPECT_GE(to_index(walks.open[i].second), 55u);
    EXPECT_TRUE(std::ranges::is_sorted(order.joining));
    const double greatest = gap2(order.within.front());
    for (std::size_t i = 1; i < order.within.size(); ++i) {
      EXPECT_LE(gap2(order.within[i]), gap2(order.within[i - 1]) + 0.05 * greatest) << "seed " << seed << ", " << i;
    }
    const CertificateOrder few = certificate_order(walks.graph, walks.open, 3);
    EXPECT_EQ(few.within, std::vector<std::uint32_t>(order.within.begin(), order.within.begin() + 3));
    EXPECT_EQ(few.joining.size(), std::min<std::size_t>(3, order.joining.size()));
  }
}

TEST(CertificateOrder, OfNothingIsNothing) {
  const CertificateOrder order = certificate_order(AppearanceGraph(4), {}, 5);
  EXPECT_TRUE(order.within.empty());
  EXPECT_TRUE(order.joining.empty());
}

// Verifications until the certificate is 0.9.
std::uint64_t certified_after(const MergeInput& input) {
  const auto merger = make_merger(input);
  while (!merger->done()) {
    merger->step();
    const MergeState& state = merger->state();
    if (state.phase != MergePhase::kVerification || state.verifications % 8 != 0) continue;
    std::vector<OpenCandidate> open;
    const auto candidates = merger->open_candidates();
    if (!candidates) continue;
    for (const Candidate& c : *candidates) open.push_back({c.source, c.target, 0});
    const Certificate certificate = certify(merger->graph(), open);
    if (certificate.open_within > 0 && certificate.certified_fraction >= 0.9) break;
  }
  return merger->state().verifications;
}

TEST(CertificateOrder, ServedTheCertificateRisesEarlierAndTheMergeEndsTheSame) {
  std::uint64_t served = 0, unserved = 0;
  for (std::uint32_t seed = 0; seed < 6; ++seed) {
    test::ToyWorld world = test::long_toy_world(seed);
    world.method = "spectral";
    MergeInput input = make_toy_merge(world);
    unserved += certified_after(input);
    const auto plain = make_merger(input);
    run(*plain, {});
    input.options.serves_certificate = true;
    served += certified_after(input);
    const auto whole = make_merger(input);
    run(*whole, {});
    EXPECT_EQ(test::edge_set(whole->state()), test::edge_set(plain->state())) << seed;
    for (std::uint64_t k = 1; k < whole->state().step; k += 37) {
      const auto first = make_merger(input);
      while (first->state().step < k) first->step();
      const auto second = make_merger(input, first->state());
      run(*second, {});
      ASSERT_EQ(second->state(), whole->state()) << "interrupted after " << k;
    }
  }
  EXPECT_LT(served, unserved * 9 / 10);
}

}  // namespace
}  // namespace mapweld
