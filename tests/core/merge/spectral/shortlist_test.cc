#include "core/merge/spectral/shortlist.h"

#include <algorithm>
#include <random>
#include <tuple>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "core/graph/components.h"
#include "core/merge/spectral/quickconnect_draw.h"
#include "tests/core/merge/spectral/quickconnect_oracle.h"

namespace mapweld {
namespace {

// Two walks in several pieces, some of which edges join; random candidates, a third of which have verdicts. Votes are
// few or a great many, odds often equal.
struct World {
  AppearanceGraph graph;
  std::vector<VertexId> sources, targets;
  std::vector<std::uint8_t> is_joined;
  CandidateEvidence evidence;

  explicit World(std::uint32_t seed) : World(seed, std::mt19937(seed)) {}
  VertexId source(std::uint32_t c) const { return sources[evidence.cell(c).row]; }
  VertexId target(std::uint32_t c) const { return targets[evidence.cell(c).column]; }

 private:
  World(std::uint32_t seed, std::mt19937 random)
      : graph(2 * kImages), is_joined(2 * kImages, 0), evidence(make_evidence(random, seed % 3 == 0 ? 60000 : 20)) {
    for (std::uint32_t v = 0; v < kImages; ++v) {
      targets.push_back(VertexId{v});
      sources.push_back(VertexId{kImages + v});
    }
    const std::uint32_t piece = seed % 4 == 0 ? 1 : 7 + seed % 40;  // images
    for (std::uint32_t v = 1; v < 2 * kImages; ++v) {
      if (v != kImages && v % piece != 0) graph.add_edge(VertexId{v - 1}, VertexId{v}, 10);
    }
    for (std::uint32_t c = 0; c < evidence.size(); ++c) {
      if (random() % 3 != 0) continue;
      const bool passed = random() % 4 == 0;
      evidence.note(c, passed);
      if (!passed) continue;
      graph.add_edge(source(c), target(c), 1);
      is_joined[to_index(source(c))] = is_joined[to_index(target(c))] = 1;
    }
  }
  static constexpr std::uint32_t kImages = 60;
  static CandidateEvidence make_evidence(std::mt19937& random, std::uint32_t most_votes) {
    std::vector<CandidateEvidence::Cell> cells;
    std::vector<float> odds;
    for (std::uint32_t row = 0; row < kImages; ++row) {
      for (std::uint32_t column = 0; column < kImages; ++column) {
        if (random() % 6 != 0) continue;
        cells.push_back({row, column, 1 + static_cast<std::uint32_t>(random()) % most_votes});
        odds.push_back(static_cast<float>(static_cast<int>(random() % 30) - 15));
      }
    }
    return {kImages, kImages, std::move(cells), std::move(odds)};
  }
};

// By definition, all of them sorted.
std::vector<std::uint32_t> best_scores(const World& world, const ScoreBasis& basis, std::size_t count) {
  const Components components = connected_components(world.graph);
  struct Score {
    std::uint32_t candidate;
    bool strengthens;
    double chance, score;
  };
  std::vector<Score> scores;
  double best = 0, best_chance = 0;
  for (std::uint32_t c = 0; c < world.evidence.size(); ++c) {
    if (world.evidence.verdict(c) != CandidateEvidence::Verdict::kNone) continue;
    const std::uint32_t a = components.component_of[to_index(world.source(c))];
    const std::uint32_t b = components.component_of[to_index(world.target(c))];
    const double chance = basis.model.chance(world.evidence.features(c)), square = chance * chance;
    Score score{c, a == components.largest() && b == components.largest(), square, 0};
    if (score.strengthens) {
      score.score = square * basis.gain.first_gain(world.source(c), world.target(c));
    } else {
      score.score =
          square * (a == b ? kWorthElsewhere : basis.join.of(std::min(components.sizes[a], components.sizes[b])));
    }
    if (score.strengthens && score.score > best) {
      best = score.score;
      best_chance = square;
    }
    scores.push_back(score);
  }
  for (Score& s : scores) {
    if (s.strengthens) s.score *= best > 0 ? best_chance / best : 0;
  }
  std::ranges::stable_sort(scores, std::ranges::greater{}, &Score::score);
  std::vector<std::uint32_t> taken;
  for (std::size_t i = 0; i < std::min(count, scores.size()); ++i) taken.push_back(scores[i].candidate);
  std::ranges::sort(taken);
  return taken;
}

TEST(Shortlist, HasTheBestScores) {
  for (std::uint32_t seed = 0; seed < 40; ++seed) {
    const World world(seed);
    const PassModel model(world.evidence.counts());
    const ConnectivityGain gain(world.graph, {}, seed % 5 != 0);
    const ScoreBasis basis{world.evidence, model, gain, world.sources, world.targets, {2, 4, world.graph.vertices()}};
    for (std::size_t count : {0, 1, 2, 7, 30, 100, 250, 399, 1000}) {
      ASSERT_EQ(draw_shortlist(basis, count), best_scores(world, basis, count)) << seed << ", " << count;
    }
  }
}

TEST(QuickConnectDraw, HasTheFirstOfItsOrder) {
  for (std::uint32_t seed = 0; seed < 40; ++seed) {
    const World world(seed);
    std::vector<Candidate> candidates;
    std::vector<bool> has_verdict, is_joined(world.is_joined.begin(), world.is_joined.end());
    for (std::uint32_t c = 0; c < world.evidence.size(); ++c) {
      candidates.push_back({world.source(c), world.target(c), world.evidence.cell(c).votes});
      has_verdict.push_back(!world.evidence.is_open(c));
    }
    std::vector<std::uint32_t> all;
    for (const auto& key : test::quickconnect_order(candidates, has_verdict, is_joined, world.graph)) {
      all.push_back(static_cast<std::uint32_t>(std::get<4>(key)));
    }
    for (const std::size_t count :
         {std::size_t{0}, std::size_t{1}, std::size_t{20}, std::size_t{65}, all.size() / 2, all.size()}) {
      const std::vector<std::uint32_t> first(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(count));
      ASSERT_EQ(draw_quickconnect(world.evidence, world.graph, world.is_joined, world.sources, world.targets, count),
                first)
          << seed << ", " << count;
    }
  }
}

}  // namespace
}  // namespace mapweld
