// What a certificate is made of reaches those who ask: the residual its lower bound, joinable vertices the stop.
#include <algorithm>
#include <memory>
#include <string_view>
#include <vector>

#include <gtest/gtest.h>

#include "core/graph/algebraic_connectivity.h"
#include "core/merge/certificate/certificate.h"
#include "core/merge/certificate/fraction_stop.h"
#include "core/merge/make_merger.h"
#include "core/merge/run.h"
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

// Every third image of the first map, and all of the second, have no edge in their own map: they can only be joined.
MergeInput with_lone_images(const test::ToyWorld& world) {
  MergeInput input = make_toy_merge(world);
  std::erase_if(input.inner_edges, [&](const Edge& e) {
    return to_index(e.u) % 3 == 0 || to_index(e.v) % 3 == 0 || to_index(e.v) >= world.sizes[0];
  });
  return input;
}

// At every moment at which a stop is asked, for every method: the component may not be about to grow.
TEST(CertificateParts, AMergeDoesNotStopWhileVerticesCanJoin) {
  int held_back = 0, stopped = 0;
  for (const std::string_view method : merge_methods()) {
    for (std::uint32_t seed = 0; seed < 6; ++seed) {
      test::ToyWorld world = test::toy_world(seed);
      world.method = method;
      world.sizes = {60, 50};
      world.places = 60;
      world.accept_share = 0.4;
      const auto merger = make_merger(with_lone_images(world));
      Outlook outlook;
      run(*merger,
          stop_when_merger([](const Merger& m) { return m.open_candidates().has_value(); }, StopReason::kPaused));
      const std::uint64_t candidates = merger->candidates_total().value();
      for (std::uint64_t at = next_fraction_test(0, candidates); !merger->done();
           at = next_fraction_test(at, candidates)) {
        run(*merger, stop_at_verifications(at));
        const std::optional<Certificate> now = outlook.certificate(*merger);
        if (!now || merger->state().verifications != at) continue;
        const FinalEstimate told = outlook.estimate(*merger).value();
        for (const double fraction : {0.01, 0.3, 0.5, 0.6, 0.7, 0.95}) {
          const bool is_certified = now->certified_fraction >= fraction, is_told = told.fraction >= fraction;
          EXPECT_EQ(stop_at_fraction(fraction, true)(*merger).has_value(), is_certified && now->joinable_vertices == 0);
          EXPECT_EQ(stop_at_fraction(fraction, false)(*merger).has_value(), is_told && told.vertices_share >= fraction);
          held_back += is_certified && now->joinable_vertices > 0 ? 1 : 0;
          stopped += is_certified && now->joinable_vertices == 0 ? 1 : 0;
        }
      }
    }
  }
  EXPECT_GT(held_back, 5);
  EXPECT_GT(stopped, 5);
}

// A walk, and images apart that each look like two of it: once some have joined, little can be gained among those, and
// most have not joined yet.
TEST(CertificateParts, AMergeDoesNotStopByEstimateWhileVerticesAreExpectedToJoin) {
  constexpr std::uint32_t kImages = 60;
  MergeInput input;
  input.members = number_members({kImages + 1, kImages});
  std::vector<std::shared_ptr<const AppearanceVector>> images;
  const auto with_words = [&](const std::vector<std::uint32_t>& words) {
    AppearanceVector image{.width_px = static_cast<int>(images.size()) + 1, .height_px = 100, .appearances = {}};
    for (const std::uint32_t word : words) image.appearances.push_back({.word = WordId{word}});
    images.push_back(std::make_shared<AppearanceVector>(image));
  };
  for (std::uint32_t i = 0; i <= kImages; ++i) with_words({i});
  for (std::uint32_t i = 0; i < kImages; ++i) with_words({i, i + 1});
  for (std::uint32_t i = 0; i < kImages; ++i) input.inner_edges.push_back({VertexId{i}, VertexId{i + 1}, 20});
  input.appearances = std::make_shared<AppearanceTable>(images);
  input.verifier = std::make_shared<test::HashVerifier>(1.0);
  input.options = {.method = "random-candidates", .min_votes = 1, .votes = VoteRule::kMin, .seed = 0};
  const auto merger = make_merger(input);
  constexpr double kFraction = 0.75;
  const StopCondition stop = stop_at_fraction(kFraction, false);
  Outlook outlook;
  int held_back = 0;
  while (!merger->done()) {
    merger->step();
    const std::uint64_t made = merger->state().verifications;
    if (merger->done() || !is_fraction_test(made, merger->candidates_total().value_or(0))) continue;
    const auto told = outlook.estimate(*merger);
    if (!told || told->fraction < kFraction || told->vertices_share >= kFraction) continue;
    ++held_back;
    EXPECT_FALSE(stop(*merger)) << "at " << made << ", share " << told->vertices_share;
  }
  EXPECT_GT(held_back, 0);
}

}  // namespace
}  // namespace mapweld
