// The order weighs a candidate's chance twice: an unlikely edge must promise more than its chance makes up for.
#include <optional>
#include <vector>

#include <gtest/gtest.h>

#include "core/merge/spectral/candidate_evidence.h"
#include "core/merge/spectral/connectivity_gain.h"
#include "core/merge/spectral/pass_model.h"
#include "core/merge/spectral/spectral_order.h"

namespace mapweld {
namespace {

// Two walks of 60 images, joined at their beginnings: a chain, whose ends are the weak place. Two candidates with few
// votes join the ends, a third with many the images `near`.
constexpr std::uint32_t kImages = 60;

struct Chain {
  AppearanceGraph graph{2 * kImages};
  std::vector<VertexId> sources, targets;
  Chain() {
    for (const std::uint32_t first : {0u, kImages}) {
      for (std::uint32_t v = first + 1; v < first + kImages; ++v) graph.add_edge(VertexId{v - 1}, VertexId{v}, 20);
    }
    graph.add_edge(VertexId{0}, VertexId{kImages}, 20);
    for (std::uint32_t v = 0; v < kImages; ++v) {
      targets.push_back(VertexId{v});
      sources.push_back(VertexId{kImages + v});
    }
  }
};

// Log-odds of the three: many votes tell.
std::vector<float> odds() { return {1, -2, -2}; }

std::vector<CandidateEvidence::Cell> cells(std::uint32_t near) {
  return {{near, near, 90}, {kImages - 2, kImages - 2, 10}, {kImages - 1, kImages - 1, 10}};
}

// Where chance times gain prefers an end, and chance squared times gain the other candidate; by what is public.
std::optional<std::uint32_t> where_the_square_decides(const Chain& chain) {
  const ConnectivityGain gain(chain.graph, SpectralOptions{}.gain);
  const PassModel model(std::vector<PassModel::Count>(PassModel::kCells));
  for (std::uint32_t near = 1; near + 10 < kImages; ++near) {
    const CandidateEvidence evidence(kImages, kImages, cells(near), odds());
    const auto worth = [&](std::uint32_t c, int power) {
      const double chance = model.chance(evidence.features(c));
      const CandidateEvidence::Cell& cell = evidence.cell(c);
      return (power == 2 ? chance * chance : chance) * gain.gain(chain.sources[cell.row], chain.targets[cell.column]);
    };
    const bool by_chance = worth(1, 1) > 1.3 * worth(0, 1) && worth(2, 1) > 1.3 * worth(0, 1);
    const bool by_square = worth(0, 2) > 1.3 * worth(1, 2) && worth(0, 2) > 1.3 * worth(2, 2);
    if (by_chance && by_square) return near;
  }
  return std::nullopt;
}

TEST(SpectralOrder, WeighsTheChanceTwice) {
  const Chain chain;
  const std::optional<std::uint32_t> near = where_the_square_decides(chain);
  ASSERT_TRUE(near);
  SpectralOptions options;
  options.quickconnect_share = 1000;
  options.least_batch = options.least_epoch = 1;
  options.epoch_vertices = 1000;
  SpectralOrder order(chain.graph, chain.sources, chain.targets, cells(*near), odds(), options);
  EXPECT_EQ(order.next_batch(), std::vector<std::uint32_t>{0}) << "of all three";
  // A short list of two of the three: it must hold the likely one.
  options.shortlist = 1;
  SpectralOrder cut(chain.graph, chain.sources, chain.targets, cells(*near), odds(), options);
  EXPECT_EQ(cut.next_batch(), std::vector<std::uint32_t>{0}) << "of the short list";
}

}  // namespace
}  // namespace mapweld
