#include "core/merge/spectral/vote_odds.h"

#include <cmath>
#include <cstdint>
#include <random>
#include <set>
#include <vector>

#include <gtest/gtest.h>

#include "core/merge/spectral/pair_blocks.h"

namespace mapweld {
namespace {

using Cell = CandidateEvidence::Cell;

// Two members of `n` images each: the first ones are columns, the others rows.
struct Pair {
  AppearanceGraph inner;
  std::vector<VertexId> sources, targets;
  explicit Pair(std::uint32_t n) : inner(2 * n) {
    for (std::uint32_t v = 0; v < n; ++v) {
      targets.push_back(VertexId{v});
      sources.push_back(VertexId{n + v});
    }
  }
};

// Every pair of images looked at.
double odds_by_definition(const Pair& pair, const std::vector<Cell>& cells, const Cell& cell) {
  const auto around = [&](VertexId v) {
    std::set<std::uint32_t> all{to_index(v)};
    for (const Neighbour& n : pair.inner.neighbours(v)) all.insert(to_index(n.vertex));
    return all;
  };
  const auto rows = around(pair.sources[cell.row]), columns = around(pair.targets[cell.column]);
  double votes = 0, candidates = 0;
  for (const Cell& c : cells) {
    if (c.row == cell.row && c.column == cell.column) continue;
    if (!rows.contains(to_index(pair.sources[c.row])) || !columns.contains(to_index(pair.targets[c.column]))) continue;
    votes += c.votes;
    ++candidates;
  }
  const double pairs = static_cast<double>(rows.size() * columns.size() - 1);
  const double mean = pairs > 0 ? votes / pairs : 0, share = pairs > 0 ? candidates / pairs : 0;
  return -7.302 + 1.622 * std::log2(cell.votes) + 2.471 * std::log2(1 + mean) - 5.886 * std::sqrt(share);
}

TEST(VoteOdds, AreThoseOfTheVotesAndTheVotesAround) {
  std::mt19937 random(3);
  for (int round = 0; round < 10; ++round) {
    const std::uint32_t n = 12;
    Pair pair(n);
    for (std::uint32_t u = 0; u < 2 * n; ++u) {
      for (std::uint32_t v = u + 1; v < 2 * n; ++v) {
        if ((u < n) == (v < n) && random() % 5 == 0) pair.inner.add_edge(VertexId{u}, VertexId{v}, 10);
      }
    }
    std::vector<Cell> cells;
    for (std::uint32_t r = 0; r < n; ++r) {
      for (std::uint32_t c = 0; c < n; ++c) {
        if (random() % 3 == 0) cells.push_back({r, c, 3 + static_cast<std::uint32_t>(random() % 60)});
      }
    }
    const std::vector<float> odds = vote_odds(pair.inner, pair.sources, pair.targets, cells);
    ASSERT_EQ(odds.size(), cells.size());
    for (std::size_t i = 0; i < cells.size(); ++i) {
      EXPECT_NEAR(odds[i], odds_by_definition(pair, cells, cells[i]), 0.0011);
      EXPECT_EQ(odds[i] * 1024, std::floor(odds[i] * 1024)) << "not on the grid";
    }
  }
}

// Of three members: what each pair has for itself is what it has among the others.
TEST(VoteOdds, OfOnePairDoNotDependOnTheOthers) {
  std::mt19937 random(4);
  std::vector<MergeMember> members(3);
  std::uint32_t vertices = 0;
  for (std::size_t m = 0; m < members.size(); ++m) {
    for (int i = 0; i < 9; ++i) members[m].vertices.push_back(VertexId{vertices++});
  }
  AppearanceGraph inner(vertices);
  for (std::uint32_t v = 0; v + 1 < vertices; ++v) {
    if (v % 9 != 8) inner.add_edge(VertexId{v}, VertexId{v + 1}, 10);
  }
  const PairBlocks blocks(members);
  const std::vector<MemberPair> pairs = all_member_pairs(members);
  std::vector<Cell> all;
  std::vector<float> apart;
  for (std::size_t p = 0; p < pairs.size(); ++p) {
    const std::vector<VertexId>&sources = members[pairs[p].m2].vertices, &targets = members[pairs[p].m1].vertices;
    std::vector<Cell> own;
    for (std::uint32_t r = 0; r < sources.size(); ++r) {
      for (std::uint32_t c = 0; c < targets.size(); ++c) {
        if (random() % 2 == 0) own.push_back({r, c, 3 + static_cast<std::uint32_t>(random() % 40)});
      }
    }
    for (const Cell& c : own) all.push_back({blocks.first_row[p] + c.row, blocks.first_column[p] + c.column, c.votes});
    const std::vector<float> odds = vote_odds(inner, sources, targets, own);
    apart.insert(apart.end(), odds.begin(), odds.end());
  }
  EXPECT_EQ(vote_odds(inner, blocks.sources, blocks.targets, all), apart);
}

}  // namespace
}  // namespace mapweld
