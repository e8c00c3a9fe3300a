// Merges of three and more maps, of maps that grow, and on several threads.
#include <algorithm>
#include <map>
#include <set>
#include <thread>

#include <gtest/gtest.h>

#include "core/errors.h"
#include "core/merge/executor.h"
#include "core/merge/make_merger.h"
#include "core/merge/methods/verification_ahead.h"
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

using PairSet = std::set<std::pair<VertexId, VertexId>>;

// Every pair of vertices of different members whose votes, counted word by word, reach min_votes and that the verifier
// accepts.
PairSet edges_by_definition(const MergeInput& input) {
  PairSet edges;
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

PairSet edges_of(const MergeState& state) {
  PairSet edges;
  for (const MergeEdge& e : state.edges) edges.emplace(e.u, e.v);
  EXPECT_EQ(edges.size(), state.edges.size()) << "an edge twice";
  return edges;
}

test::ToyWorld several(std::uint32_t seed) {
  test::ToyWorld world = test::toy_world(seed);
  const std::vector<std::vector<std::uint32_t>> shapes{{8, 8, 8}, {12, 5, 9}, {4, 9, 6, 7}, {0, 5, 6}, {3, 3, 3, 3, 3}};
  world.sizes = shapes[seed % shapes.size()];
  return world;
}

TEST(SeveralMaps, EndWithAllEdgesBetweenAnyTwo) {
  std::size_t edges = 0;
  for (std::uint32_t seed = 0; seed < 25; ++seed) {
    for (const std::string_view method : merge_methods()) {
      test::ToyWorld world = several(seed);
      world.method = method;
      const MergeInput input = make_toy_merge(world);
      const auto merger = make_merger(input);
      run(*merger, {});
      const PairSet expected = edges_by_definition(input);
      if (method == "alignment") {  // the one method with a candidate set of its own
        EXPECT_TRUE(std::ranges::includes(expected, edges_of(merger->state())));
        continue;
      }
      EXPECT_EQ(edges_of(merger->state()), expected) << method << " seed " << seed;
      edges += expected.size();
    }
  }
  EXPECT_GT(edges, 1200u);
}

TEST(SeveralMaps, ThePairWithTheMostCandidatesComesFirst) {
  test::ToyWorld world = several(1);
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
    test::ToyWorld world = several(2);
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
    test::ToyWorld world = several(2);
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
    test::ToyWorld world = several(seed);
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
    test::ToyWorld world = several(seed);
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
      EXPECT_EQ(edges_of(resumed->state()), edges_of(fresh->state())) << seed << " at " << verifications;
      EXPECT_EQ(resumed->state().verifications, fresh->state().verifications);
      EXPECT_EQ(resumed->state().candidates_known, fresh->state().candidates_known);
      run(*merger, {});
      EXPECT_EQ(merger->state(), resumed->state());
    }
  }
  test::ToyWorld world = several(1), other = world;
  world.method = other.method = "spectral";
  other.min_votes += 1;
  const MergeState before = former_state(make_toy_merge(world), stop_at_verifications(5));
  EXPECT_THROW(make_merger(make_toy_merge(other), before), FormatError) << "other rules";
}

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
      EXPECT_EQ(edges_of(resumed->state()), edges_of(fresh->state())) << method << " seed " << seed;
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

// Four threads, whatever the machine has.
class Threads final : public Executor {
 public:
  std::size_t concurrency() const override { return 4; }
  void run(std::size_t pieces, const std::function<void(std::size_t)>& piece) const override {
    std::vector<std::thread> threads;
    for (std::size_t t = 0; t < 4; ++t) {
      threads.emplace_back([&, t] {
        for (std::size_t i = t; i < pieces; i += 4) piece(i);
      });
    }
    for (std::thread& thread : threads) thread.join();
    batches += 1;
    largest = std::max(largest, pieces);
  }
  mutable std::size_t batches = 0, largest = 0;
};

TEST(VerifyingAhead, ChangesNothing) {
  std::size_t largest = 0;
  for (const std::string_view method : merge_methods()) {
    for (std::uint32_t seed = 0; seed < 12; ++seed) {
      test::ToyWorld world = test::toy_world(seed);
      if (seed % 3 == 0) world = several(seed);
      world.method = method;
      MergeInput input = make_toy_merge(world);
      const auto serial = make_merger(input);
      run(*serial, {});
      const auto threads = std::make_shared<Threads>();
      input.executor = threads;
      const auto parallel = make_merger(input);
      run(*parallel, {}, [&, before = std::uint64_t{0}](const Merger& m) mutable {
        EXPECT_LE(m.state().verifications, before + 1);
        before = m.state().verifications;
      });
      EXPECT_EQ(parallel->state(), serial->state()) << method << " seed " << seed;
      largest = std::max(largest, threads->largest);
    }
  }
  EXPECT_EQ(largest, VerificationAhead::kBatch);
}

TEST(VerifyingAhead, StopsAtExactlySoManyVerifications) {
  test::ToyWorld world = test::toy_world(5);
  MergeInput input = make_toy_merge(world);
  const auto serial = make_merger(input);
  run(*serial, stop_at_verifications(37));
  input.executor = std::make_shared<Threads>();
  const auto parallel = make_merger(input);
  run(*parallel, stop_at_verifications(37));
  EXPECT_EQ(parallel->state().verifications, 37u);
  EXPECT_EQ(parallel->state(), serial->state());
}

}  // namespace
}  // namespace mapweld
