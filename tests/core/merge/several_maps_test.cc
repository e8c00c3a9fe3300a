// Merges of three and more maps.
#include <algorithm>
#include <map>
#include <set>

#include <gtest/gtest.h>

#include "core/errors.h"
#include "core/merge/make_merger.h"
#include "core/merge/run.h"
#include "core/merge/vote_source.h"
#include "tests/core/merge/toy_maps.h"
#include "tests/core/merge/verdict_log.h"
#include "tests/core/retrieval/random_images.h"

namespace mapweld {
namespace {

std::uint32_t votes_by_definition(const AppearanceVector& a, const AppearanceVector& b, VoteRule rule) {
  if (rule == VoteRule::kSignatures) return test::votes_by_signatures(a, b);
  std::map<WordId, std::pair<std::uint32_t, std::uint32_t>> counts;
  for (const Appearance& x : a.appearances) ++counts[x.word].first;
  for (const Appearance& x : b.appearances) ++counts[x.word].second;
  std::uint32_t votes = 0;
  for (const auto& [word, c] : counts) {
    votes += rule == VoteRule::kMin ? std::min(c.first, c.second) : c.first * c.second;
  }
  return votes;
}

// Every pair of vertices of different members whose votes, counted word by word, reach min_votes and that the verifier
// accepts.
test::PairSet edges_by_definition(const MergeInput& input) {
  test::PairSet edges;
  for (std::size_t i = 0; i < input.members.size(); ++i) {
    for (std::size_t j = i + 1; j < input.members.size(); ++j) {
      for (const VertexId u : input.members[i].vertices) {
        for (const VertexId v : input.members[j].vertices) {
          const auto a = input.appearances->appearances(u), b = input.appearances->appearances(v);
          const std::uint32_t votes = votes_by_definition(*a, *b, input.options.votes);
          if (votes < input.options.min_votes || !input.verifier->verify(*a, *b).accepted) continue;
          edges.emplace(std::min(u, v), std::max(u, v));
        }
      }
    }
  }
  return edges;
}

TEST(SeveralMaps, EndWithAllEdgesBetweenAnyTwo) {
  std::size_t edges = 0;
  for (std::uint32_t seed = 0; seed < 25; ++seed) {
    for (const std::string_view method : merge_methods()) {
      test::ToyWorld world = test::toy_world_of_several(seed);
      world.method = method;
      const MergeInput input = make_toy_merge(world);
      const auto merger = make_merger(input);
      run(*merger, {});
      const test::PairSet expected = edges_by_definition(input);
      if (method == "alignment") {  // the one method with a candidate set of its own
        EXPECT_TRUE(std::ranges::includes(expected, test::edges_of(merger->state())));
        continue;
      }
      EXPECT_EQ(test::edges_of(merger->state()), expected) << method << " seed " << seed;
      edges += expected.size();
    }
  }
  EXPECT_GT(edges, 1200u);
}

TEST(SeveralMaps, ThePairWithTheMostCandidatesComesFirst) {
  test::ToyWorld world = test::toy_world_of_several(1);
  world.method = "brute-force";
  world.min_votes = 4;
  const MergeInput input = make_toy_merge(world);
  std::vector<std::uint64_t> candidates;
  for (const MemberPair& pair : all_member_pairs(input.members)) {
    const WordVotes votes(*input.appearances, input.members[pair.m1], input.members[pair.m2]);
    candidates.push_back(count_candidates(votes, input.options.votes, input.options.min_votes));
  }
  std::ranges::sort(candidates, std::ranges::greater{});
  const auto merger = make_merger(input);
  std::vector<std::uint64_t> verified(candidates.size(), 0);
  std::uint64_t before = 0;
  while (!merger->done()) {
    const std::uint32_t pair = merger->state().pair;
    merger->step();
    verified[pair] += merger->state().verifications - before;
    before = merger->state().verifications;
  }
  EXPECT_EQ(verified, candidates);
  EXPECT_GT(candidates.front(), candidates.back());
}

TEST(SeveralMaps, APairIsFinishedWhenAllItsCandidatesHaveAVerdict) {
  std::size_t early = 0;
  for (const std::string_view method : merge_methods()) {
    test::ToyWorld world = test::toy_world_of_several(2);
    world.method = method;
    const MergeInput input = make_toy_merge(world);
    const std::size_t n = input.members.size();
    const auto whole = make_merger(input);
    run(*whole, {});
    const auto verdicts_of = [&](const MergeState& state) {
      std::vector<std::size_t> verdicts(n * (n - 1) / 2, 0);
      const auto member = [&](VertexId v) {
        return std::ranges::find_if(
                   input.members,
                   [&](const MergeMember& m) { return std::ranges::find(m.vertices, v) != m.vertices.end(); }) -
               input.members.begin();
      };
      const auto count = [&](VertexId u, VertexId v) {
        std::size_t place = 0;
        const auto [i, j] = std::minmax({member(u), member(v)});
        for (std::ptrdiff_t a = 0; a < i; ++a) place += n - 1 - static_cast<std::size_t>(a);
        ++verdicts[place + static_cast<std::size_t>(j - i - 1)];
      };
      for (const MergeEdge& e : state.edges) count(e.u, e.v);
      for (const RejectedPair& r : state.rejected) count(r.source, r.target);
      return verdicts;
    };
    const std::vector<std::size_t> expected = verdicts_of(whole->state());
    const auto merger = make_merger(input);
    while (!merger->done()) {
      const std::vector<bool> finished = merger->finished_pairs();
      const std::vector<std::size_t> verdicts = verdicts_of(merger->state());
      for (std::size_t place = 0; place < finished.size(); ++place) {
        if (finished[place]) {
          EXPECT_EQ(verdicts[place], expected[place]) << method;
          ++early;
        } else if (method == "spectral" && merger->state().phase == MergePhase::kVoting) {
          continue;                          // nobody has counted its candidates yet
        } else if (method != "alignment") {  // which has a candidate set of its own
          EXPECT_LT(verdicts[place], expected[place]) << method;
        }
      }
      merger->step();
    }
    EXPECT_EQ(merger->finished_pairs(), std::vector<bool>(expected.size(), true));
  }
  EXPECT_GT(early, 100u);
}

TEST(SeveralMaps, ResumeAfterEveryStep) {
  for (const std::string_view method : merge_methods()) {
    test::ToyWorld world = test::toy_world_of_several(2);
    world.method = method;
    const MergeInput input = make_toy_merge(world);
    const auto whole = make_merger(input);
    run(*whole, {});
    auto merger = make_merger(input);
    while (!merger->done()) {
      merger->step();
      merger = make_merger(input, merger->state());
    }
    EXPECT_EQ(merger->state(), whole->state()) << method;
  }
}

// Spectral counts all votes first; then everything that all candidates are needed for is there.
TEST(SeveralMaps, SpectralKnowsAllCandidatesOnceTheVotesAreIn) {
  for (std::uint32_t seed = 0; seed < 10; ++seed) {
    test::ToyWorld world = test::toy_world_of_several(seed);
    world.method = "spectral";
    const MergeInput input = make_toy_merge(world);
    std::uint64_t candidates = 0;
    for (const MemberPair& pair : all_member_pairs(input.members)) {
      const WordVotes votes(*input.appearances, input.members[pair.m1], input.members[pair.m2]);
      candidates += count_candidates(votes, input.options.votes, input.options.min_votes);
    }
    const auto merger = make_merger(input);
    std::uint64_t known = 0;
    const auto look = [&](const Merger& m) {
      EXPECT_GE(m.state().candidates_known, known);
      known = m.state().candidates_known;
      if (m.state().phase == MergePhase::kVoting) {
        EXPECT_EQ(m.state().verifications, 0u);
        EXPECT_FALSE(m.candidates_total());
        EXPECT_FALSE(m.open_candidates());
        return;
      }
      EXPECT_EQ(known, candidates);
      EXPECT_EQ(m.candidates_total(), candidates);
      EXPECT_EQ(m.open_candidates().value().size(), candidates - m.state().verifications);
    };
    look(*merger);
    run(*merger, {}, look);
    EXPECT_EQ(merger->state().verifications, candidates);
  }
}

// What a program left that went through the pairs one after the other: as brute force does, whose states told the same
// of the members.
MergeState former_state(const MergeInput& input, const StopCondition& stop) {
  MergeInput by_pairs = input;
  by_pairs.options.method = "brute-force";
  const auto merger = make_merger(by_pairs);
  run(*merger, stop);
  MergeState state = merger->state();
  const auto spectral = make_merger(input);
  EXPECT_NE(state.input_fingerprint, spectral->state().input_fingerprint);
  state.method = "spectral";
  state.rules_fingerprint = spectral->state().rules_fingerprint;
  return state;
}

TEST(SeveralMaps, AStateThatWentPairAfterPairGoesOnInOneOrder) {
  for (std::uint32_t seed = 0; seed < 10; ++seed) {
    test::ToyWorld world = test::toy_world_of_several(seed);
    world.method = "spectral";
    const MergeInput input = make_toy_merge(world);
    const auto fresh = make_merger(input);
    run(*fresh, {});
    for (std::uint64_t verifications = 0; verifications <= fresh->state().verifications; verifications += 3) {
      const MergeState before = former_state(input, stop_at_verifications(verifications));
      const auto merger = make_merger(input, before);
      EXPECT_EQ(merger->state().verifications, before.verifications);
      run(*merger, stop_at_verifications(verifications + 5));
      const auto resumed = make_merger(input, merger->state());
      run(*resumed, {});
      EXPECT_EQ(test::edges_of(resumed->state()), test::edges_of(fresh->state())) << seed << " at " << verifications;
      EXPECT_EQ(resumed->state().verifications, fresh->state().verifications);
      EXPECT_EQ(resumed->state().candidates_known, fresh->state().candidates_known);
      run(*merger, {});
      EXPECT_EQ(merger->state(), resumed->state());
    }
  }
  test::ToyWorld world = test::toy_world_of_several(1), other = world;
  world.method = other.method = "spectral";
  other.min_votes += 1;
  const MergeState before = former_state(make_toy_merge(world), stop_at_verifications(5));
  EXPECT_THROW(make_merger(make_toy_merge(other), before), FormatError) << "other rules";
}

}  // namespace
}  // namespace mapweld
