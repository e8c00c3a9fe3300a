// What a certificate is made of reaches those who ask: the residual its lower bound, joinable vertices the stop.
#include <algorithm>
#include <string_view>
#include <vector>

#include <gtest/gtest.h>

#include "core/graph/algebraic_connectivity.h"
#include "core/merge/certificate/certificate.h"
#include "core/merge/certificate/fraction_stop.h"
#include "core/merge/make_merger.h"
#include "tests/core/graph/sample_graphs.h"
#include "tests/core/merge/toy_maps.h"

namespace mapweld {
namespace {

TEST(CertificateParts, AnInexactEigenvalueCountsForLessByItsResidual) {
  const AppearanceGraph path = test::path(40);
  const std::vector<OpenCandidate> open{{VertexId{0}, VertexId{39}, 0.5}};
  LargestComponentConnectivity largest = largest_component_connectivity(path);
  const Certificate exact = certify(path, largest, open);
  const double value = largest.connectivity.value;
  largest.connectivity.residual = value / 4;
  const Certificate inexact = certify(path, largest, open);
  EXPECT_NEAR(inexact.lower_bound, 0.75 * value, 1e-6 * value);
  EXPECT_NEAR(inexact.certified_fraction, 0.75 * exact.certified_fraction, 1e-6);
  largest.connectivity.residual = 2 * value;
  EXPECT_EQ(certify(path, largest, open).certified_fraction, 0);
}

// Every seventh image has no edge in its own map: it can only be joined.
MergeInput with_lone_images(const test::ToyWorld& world) {
  MergeInput input = make_toy_merge(world);
  std::erase_if(input.inner_edges, [](const Edge& e) { return to_index(e.u) % 7 == 0 || to_index(e.v) % 7 == 0; });
  return input;
}

// At every moment at which a stop is asked, for every method: the component may not be about to grow.
TEST(CertificateParts, AMergeDoesNotStopWhileVerticesCanJoin) {
  int held_back = 0, held_back_likely = 0, stopped = 0;
  for (const std::string_view method : merge_methods()) {
    for (std::uint32_t seed = 0; seed < 6; ++seed) {
      test::ToyWorld world = test::toy_world(seed);
      world.method = method;
      world.sizes = {60, 50};
      world.places = 60;
      world.accept_share = 0.4;
      const auto merger = make_merger(with_lone_images(world));
      for (std::uint64_t at = next_fraction_test(0); !merger->done(); at = next_fraction_test(at)) {
        run(*merger, stop_at_verifications(at));
        const std::optional<Certificate> now = certify(*merger);
        if (!now || merger->state().verifications != at) continue;
        EXPECT_LE(now->likely_joinable_vertices, now->joinable_vertices);
        for (const double fraction : {0.01, 0.3, 0.7}) {
          const bool is_certified = now->certified_fraction >= fraction, is_told = now->estimated_fraction >= fraction;
          EXPECT_EQ(stop_at_fraction(fraction, true)(*merger).has_value(), is_certified && now->joinable_vertices == 0);
          EXPECT_EQ(stop_at_fraction(fraction, false)(*merger).has_value(),
                    is_told && now->likely_joinable_vertices == 0);
          held_back += is_certified && now->joinable_vertices > 0 ? 1 : 0;
          held_back_likely += is_told && now->likely_joinable_vertices > 0 ? 1 : 0;
          stopped += is_certified && now->joinable_vertices == 0 ? 1 : 0;
        }
      }
    }
  }
  EXPECT_GT(held_back, 5);
  EXPECT_GT(held_back_likely, 5);
  EXPECT_GT(stopped, 5);
}

}  // namespace
}  // namespace mapweld
