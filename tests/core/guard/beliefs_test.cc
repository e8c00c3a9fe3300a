#include "core/guard/beliefs.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include <gtest/gtest.h>

namespace mapweld {
namespace {

struct Case {
  std::uint32_t n = 0;  // vertices of either side
  LinkLists links;
  struct E {
    std::uint32_t u, v;
    double fullness;
    int rare;
  };
  std::vector<E> edges;
};

Case random_case(std::uint64_t seed) {
  Case c;
  std::mt19937_64 random(seed);
  const auto below = [&](std::uint32_t n) { return static_cast<std::uint32_t>(random() % n); };
  c.n = 12;
  c.links.resize(2 * c.n);
  for (int k = 0; k < 20; ++k) {
    const std::uint32_t side = below(2) * c.n, x = side + below(c.n), y = side + below(c.n);
    const double belief = below(3) == 0 ? std::numeric_limits<double>::infinity() : below(60) / 10.0;
    if (x == y || std::ranges::any_of(c.links[x], [&](const Link& l) { return l.to == y; })) continue;
    c.links[x].push_back({y, belief});
    c.links[y].push_back({x, belief});
  }
  for (auto& list : c.links) std::ranges::sort(list);
  for (std::uint32_t u = 0; u < c.n; ++u) {
    for (std::uint32_t v = 0; v < c.n; ++v) {
      if (below(4) == 0) c.edges.push_back({u, c.n + v, below(40) / 10.0, static_cast<int>(below(60))});
    }
  }
  std::ranges::shuffle(c.edges, random);
  return c;
}

EdgeSigns signs_of(const Case::E& e) {
  EdgeSigns signs;
  signs.rare_matches = e.rare;
  signs.far_images = 50;
  signs.fullness = e.fullness;
  signs.inner_fullness = 2;
  return signs;
}

// By the definition: how far a chain from f to e is believed, for all pairs, until nothing changes.
std::vector<double> expected(const Case& c, const EvidenceModel& model) {
  const auto along = [&](std::uint32_t x, std::uint32_t y) {
    if (x == y) return std::numeric_limits<double>::infinity();
    for (const Link& l : c.links[x]) {
      if (l.to == y) return l.belief;
    }
    return -std::numeric_limits<double>::infinity();
  };
  const std::size_t n = c.edges.size();
  std::vector<double> belief(n);
  for (std::size_t e = 0; e < n; ++e) {
    EdgeSigns signs = signs_of(c.edges[e]);
    for (const Case::E& f : c.edges) {
      const double seen = std::min({f.fullness, along(c.edges[e].u, f.u), along(c.edges[e].v, f.v)});
      signs.fullness_around = std::max(signs.fullness_around, seen);
    }
    belief[e] = weigh(signs, model).sum();
  }
  for (bool changed = true; changed;) {
    changed = false;
    for (std::size_t e = 0; e < n; ++e) {
      for (std::size_t f = 0; f < n; ++f) {
        if (e == f) continue;
        const double chain =
            std::min({belief[f], along(c.edges[e].u, c.edges[f].u), along(c.edges[e].v, c.edges[f].v)});
        if (chain - model.step <= belief[e]) continue;
        belief[e] = chain - model.step;
        changed = true;
      }
    }
  }
  return belief;
}

TEST(Beliefs, AreWhatTheDefinitionSaysHoweverTheEdgesCome) {
  const EvidenceModel model;
  int grown = 0;
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    const Case c = random_case(seed);
    const std::vector<double> want = expected(c, model);
    for (const std::size_t batch : {std::size_t{1}, std::size_t{5}, c.edges.size()}) {
      Beliefs beliefs(c.links, c.links, model, false);
      for (std::size_t e = 0; e < c.edges.size(); ++e) {
        beliefs.add(c.edges[e].u, c.edges[e].v, signs_of(c.edges[e]));
        if ((e + 1) % batch == 0) beliefs.settle();
      }
      beliefs.settle();
      for (std::uint32_t e = 0; e < beliefs.size(); ++e) {
        ASSERT_EQ(beliefs.belief(e), want[e]) << "seed " << seed << ", edge " << e;
        grown += beliefs.belief(e) > weigh(beliefs.signs(e), model).sum() ? 1 : 0;
      }
    }
  }
  EXPECT_GT(grown, 100);
}

TEST(Beliefs, AFullEdgeIsSeenAsFarAsTheLinksToItAreFull) {
  LinkLists around(4);  // 0 - 1 on one side, 2 - 3 on the other
  around[0] = {{1, 0.8}};
  around[1] = {{0, 0.8}};
  around[2] = {{3, 2.5}};
  around[3] = {{2, 2.5}};
  const LinkLists none(4);
  Beliefs beliefs(around, none, {}, false);
  EdgeSigns full, faint;
  full.fullness = 5;
  faint.fullness = 0.3;
  beliefs.add(0, 2, faint);
  beliefs.add(0, 3, faint);
  beliefs.add(1, 3, full);
  beliefs.settle();
  EXPECT_EQ(beliefs.signs(0).fullness_around, 0.8);
  EXPECT_EQ(beliefs.signs(1).fullness_around, 0.8);
  EXPECT_EQ(beliefs.signs(2).fullness_around, 5);
}

TEST(Beliefs, AChainIsAsStrongAsItsWeakestLink) {
  LinkLists links(4);  // 0 - 1 on one side, 2 - 3 on the other
  links[0] = {{1, 1.5}};
  links[1] = {{0, 1.5}};
  links[2] = {{3, 9}};
  links[3] = {{2, 9}};
  const LinkLists none(4);
  const EvidenceModel model;
  Beliefs beliefs(none, links, model, false);
  EdgeSigns strong, weak;
  strong.rare_matches = 1000;
  strong.far_images = 1000;
  beliefs.add(0, 2, strong);
  beliefs.add(1, 3, weak);
  beliefs.settle();
  EXPECT_EQ(beliefs.belief(1), 1.5 - model.step);
}

}  // namespace
}  // namespace mapweld
