// Merges of maps that have grown since.
#include <algorithm>
#include <memory>
#include <set>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "core/errors.h"
#include "core/merge/make_merger.h"
#include "core/merge/run.h"
#include "tests/core/merge/toy_maps.h"
#include "tests/core/merge/verdict_log.h"

namespace mapweld {
namespace {

// The first `sizes` vertices of each member of `grown`, which keep their numbers; later ones follow as they come.
MergeInput before_growth(const MergeInput& grown, const std::vector<std::uint32_t>& sizes) {
  MergeInput input = grown;
  std::set<VertexId> kept;
  for (std::size_t k = 0; k < sizes.size(); ++k) {
    input.members[k].vertices.resize(sizes[k]);
    kept.insert(input.members[k].vertices.begin(), input.members[k].vertices.end());
  }
  std::erase_if(input.inner_edges, [&](const Edge& e) { return !kept.contains(e.u) || !kept.contains(e.v); });
  return input;
}

// A toy merge whose members' first vertices have the lowest numbers: so they would be numbered if the rest came later.
MergeInput numbered_by_growth(const test::ToyWorld& world, const std::vector<std::uint32_t>& first) {
  MergeInput input = make_toy_merge(world);
  std::vector<std::uint32_t> number(input.members[0].vertices.size() + input.members[1].vertices.size());
  std::uint32_t next = 0;
  for (int later = 0; later < 2; ++later) {
    for (std::size_t k = 0; k < 2; ++k) {
      const auto& vertices = input.members[k].vertices;
      for (std::size_t i = later ? first[k] : 0; i < (later ? vertices.size() : first[k]); ++i) {
        number[to_index(vertices[i])] = next++;
      }
    }
  }
  std::vector<std::shared_ptr<const AppearanceVector>> vectors(number.size());
  for (std::uint32_t v = 0; v < number.size(); ++v) {
    vectors[number[v]] = input.appearances->appearances(VertexId{v});
  }
  input.appearances = std::make_shared<AppearanceTable>(std::move(vectors));
  for (MergeMember& member : input.members) {
    for (VertexId& v : member.vertices) v = VertexId{number[to_index(v)]};
  }
  for (Edge& e : input.inner_edges) {
    const std::uint32_t u = number[to_index(e.u)], v = number[to_index(e.v)];
    e.u = VertexId{std::min(u, v)};
    e.v = VertexId{std::max(u, v)};
  }
  return input;
}

TEST(GrowingMaps, EndWithTheEdgesOfAFreshMergeAndAskNothingTwice) {
  class Counting final : public PairVerifier {
   public:
    explicit Counting(std::shared_ptr<const PairVerifier> inner) : inner_(std::move(inner)) {}
    Verification verify(const AppearanceVector& a, const AppearanceVector& b) const override {
      EXPECT_TRUE(asked.insert(std::minmax(a.width_px, b.width_px)).second) << "a pair was verified twice";
      return inner_->verify(a, b);
    }
    std::string version() const override { return inner_->version(); }
    const VerifierOptions& options() const override { return inner_->options(); }
    mutable std::set<std::pair<int, int>> asked;

   private:
    std::shared_ptr<const PairVerifier> inner_;
  };
  for (const std::string_view method : merge_methods()) {
    if (method == "alignment") continue;  // an alignment of longer sequences may leave a pair out that it had before
    for (std::uint32_t seed = 0; seed < 20; ++seed) {
      test::ToyWorld world = test::toy_world(seed);
      world.method = method;
      world.sizes = {12 + seed % 5, 14 - seed % 7};  // either may be the larger, before and after
      const std::vector<std::uint32_t> first{5 + seed % 7, 8};
      MergeInput grown = numbered_by_growth(world, first);
      const auto fresh = make_merger(grown);
      run(*fresh, {});

      const auto counting = std::make_shared<Counting>(grown.verifier);
      grown.verifier = counting;
      MergeInput early = before_growth(grown, first);
      const auto before = make_merger(early);
      // Stopped half-way in every other world.
      if (seed % 2 == 0)
        run(*before, {});
      else
        run(*before, stop_at_verifications(4));
      const std::uint64_t verified_before = before->state().verifications;
      const auto after = make_grown_merger(grown, before->state());
      EXPECT_EQ(after->state().verifications, verified_before);
      EXPECT_EQ(after->graph().edges(), grown.inner_edges.size() + before->state().edges.size());
      // And once more through a state, half-way.
      run(*after, stop_at_verifications(verified_before + 3));
      const auto resumed = make_merger(grown, after->state());
      run(*resumed, {});
      EXPECT_EQ(test::edges_of(resumed->state()), test::edges_of(fresh->state())) << method << " seed " << seed;
      EXPECT_EQ(resumed->state().verifications, fresh->state().verifications) << method << " seed " << seed;
    }
  }
}

TEST(GrowingMaps, RefuseAStateOfOtherRules) {
  test::ToyWorld world;
  const auto merger = make_merger(make_toy_merge(world));
  run(*merger, stop_at_verifications(5));
  world.min_votes += 1;
  EXPECT_THROW(make_grown_merger(make_toy_merge(world), merger->state()), FormatError);
}

}  // namespace
}  // namespace mapweld
