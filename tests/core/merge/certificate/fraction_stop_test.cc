// The certificate of a running merge, stopping at a fraction, the chance to pass, and the table of members.
#include "core/merge/certificate/fraction_stop.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include <gtest/gtest.h>

#include "core/graph/algebraic_connectivity.h"
#include "core/graph/components.h"
#include "core/merge/make_merger.h"
#include "core/merge/member_table.h"
#include "tests/core/merge/toy_maps.h"

namespace mapweld {
namespace {

// What stop_at_fraction and a job's status tell is held against the merge's own end, for every method: at no moment
// does the certificate say more than was true of the component of that moment.
TEST(FractionOfAMerge, IsNeverCertifiedTooHigh) {
  std::map<std::string_view, int> told;
  for (const std::string_view method : merge_methods()) {
    for (std::uint32_t seed = 0; seed < 9; ++seed) {
      const MergeInput input = make_toy_merge(test::large_toy_world(seed, method));
      const auto whole = make_merger(input);
      run(*whole, {});
      const auto merger = make_merger(input);
      Outlook outlook;
      while (!merger->done()) {
        const std::uint64_t next = merger->state().verifications + 40;
        run(*merger, stop_at_verifications(next));
        const std::optional<Certificate> now = outlook.certificate(*merger);
        if (!now) continue;
        const LargestComponentConnectivity largest = largest_component_connectivity(merger->graph());
        const AppearanceGraph end = induced_subgraph(whole->graph(), largest.vertices);
        const double at_end = algebraic_connectivity(end).value;
        if (at_end == 0) continue;
        ++told[method];
        EXPECT_LE(now->certified_fraction, largest.connectivity.value / at_end * (1 + 1e-9))
            << method << " seed " << seed << " at " << merger->state().verifications;
        if (now->joinable_vertices == 0) {
          const Components components = connected_components(whole->graph());
          EXPECT_EQ(components.sizes[components.component_of[to_index(largest.vertices.front())]],
                    largest.vertices.size());
        }
      }
      const std::optional<Certificate> at_end = outlook.certificate(*merger);
      ASSERT_TRUE(at_end);
      EXPECT_EQ(at_end->certified_fraction, 1);
      EXPECT_EQ(at_end->joinable_vertices, 0u);
    }
  }
  for (const std::string_view method : merge_methods()) {
    if (method == "alignment") continue;  // random places make no sequences
    EXPECT_GT(told[method], 8) << method;
  }
}

TEST(FractionOfAMerge, TheOpenCandidatesAreThoseThatAreVerifiedLater) {
  for (const std::string_view method : merge_methods()) {
    const MergeInput input = make_toy_merge(test::large_toy_world(3, method));
    const auto merger = make_merger(input);
    run(*merger, stop_when_merger(
                     [](const Merger& m) { return m.open_candidates().has_value() && m.state().verifications >= 20; },
                     StopReason::kPaused));
    std::set<std::pair<VertexId, VertexId>> open, later;
    const std::vector<Candidate> candidates = merger->open_candidates().value();
    for (const Candidate& c : candidates) open.insert(std::minmax(c.source, c.target));
    const std::size_t edges = merger->state().edges.size(), rejected = merger->state().rejected.size();
    run(*merger, {});
    const MergeState& end = merger->state();
    for (std::size_t i = edges; i < end.edges.size(); ++i) later.emplace(end.edges[i].u, end.edges[i].v);
    for (std::size_t i = rejected; i < end.rejected.size(); ++i) {
      later.insert(std::minmax(end.rejected[i].source, end.rejected[i].target));
    }
    EXPECT_EQ(open, later) << method;
  }
}

// A merge that stops for its fraction, and where.
struct FractionCase {
  MergeInput input;
  double fraction = 0;
  bool certified = false;
  MergeState stopped;  // uninterrupted
  std::uint64_t candidates = 0;
};

std::vector<FractionCase> stopping_cases() {
  std::vector<FractionCase> cases;
  for (const std::string_view method : merge_methods()) {
    {
      const MergeInput input = make_toy_merge(test::large_toy_world(1, method));
      for (const bool certified : {true, false}) {
        for (const double fraction : {0.5, 0.8}) {
          const auto straight = make_merger(input);
          const auto reason = run(*straight, stop_at_fraction(fraction, certified));
          if (!reason) continue;
          EXPECT_EQ(*reason, StopReason::kFractionOfMaximum);
          Outlook outlook;
          EXPECT_GE(certified
                        ? outlook.certificate(*straight)->certified_fraction
                        : std::min(outlook.estimate(*straight)->fraction, outlook.estimate(*straight)->vertices_share),
                    fraction);
          const std::uint64_t candidates = straight->candidates_total().value();
          EXPECT_TRUE(is_fraction_test(straight->state().verifications, candidates));
          cases.push_back({input, fraction, certified, straight->state(), candidates});
        }
      }
    }
  }
  return cases;
}

// Goes on from `from` until the fraction stops it; first it is stopped by `interruption`, asked before the fraction or
// after it, and made anew from its state.
MergeState interrupted(const FractionCase& of, const MergeState& from, const StopCondition& interruption,
                       bool interruption_first) {
  const auto before = make_merger(of.input, from);
  std::vector<StopCondition> conditions{stop_at_fraction(of.fraction, of.certified), interruption};
  if (interruption_first) std::swap(conditions[0], conditions[1]);
  if (run(*before, stop_at_first(conditions)) == StopReason::kFractionOfMaximum) return before->state();
  const auto after = make_merger(of.input, before->state());
  run(*after, stop_at_fraction(of.fraction, of.certified));
  return after->state();
}

TEST(StopAtFraction, StopsWhereAnUninterruptedMergeStopsWhateverInterruptsIt) {
  const std::vector<FractionCase> cases = stopping_cases();
  EXPECT_GE(cases.size(), 12u);
  for (const FractionCase& of : cases) {
    // Every state of the merge that has made as many verifications as a test takes, one fewer, or one more.
    const auto walked = make_merger(of.input);
    std::uint64_t at_tests = 0;
    for (;;) {
      const std::uint64_t made = walked->state().verifications;
      const bool is_at_stop = walked->state().step == of.stopped.step;
      if (is_fraction_test(made, of.candidates) || is_fraction_test(made + 1, of.candidates) ||
          (made > 0 && is_fraction_test(made - 1, of.candidates))) {
        at_tests += is_fraction_test(made, of.candidates) ? 1 : 0;
        // Killed here: a new merger goes on.
        const auto resumed = make_merger(of.input, walked->state());
        run(*resumed, stop_at_fraction(of.fraction, of.certified));
        ASSERT_EQ(resumed->state(), of.stopped) << of.stopped.method << " killed at " << made;
      }
      if (is_at_stop) break;
      walked->step();
    }
    EXPECT_GE(at_tests, 1u);
    // Stopped by a pause and by a budget around tests, the deciding one among them, in either order of the conditions.
    const MergeState start = make_merger(of.input)->state();
    std::vector<std::uint64_t> tests{next_fraction_test(0, of.candidates), of.stopped.verifications};
    for (std::uint64_t test = tests[0]; test < tests[1]; test = next_fraction_test(2 * test, of.candidates)) {
      tests.push_back(test);
    }
    for (const std::uint64_t test : tests) {
      for (const std::uint64_t made : {test - 1, test, test + 1}) {
        const auto paused =
            stop_when_merger([made](const Merger& m) { return m.state().verifications >= made; }, StopReason::kPaused);
        for (const StopCondition& interruption : {paused, stop_at_verifications(made)}) {
          for (const bool first : {true, false}) {
            ASSERT_EQ(interrupted(of, start, interruption, first), of.stopped)
                << of.stopped.method << " stopped at " << made << (first ? " before" : " after") << " the fraction";
          }
        }
      }
    }
  }
}

TEST(StopAtFraction, HoldsOfAMergeThatItHasStoppedAndSoDoesALowerFraction) {
  for (const FractionCase& of : stopping_cases()) {
    for (const double fraction : {of.fraction, of.fraction / 2}) {
      const auto resumed = make_merger(of.input, of.stopped);
      EXPECT_EQ(run(*resumed, stop_at_fraction(fraction, of.certified)), StopReason::kFractionOfMaximum);
      EXPECT_EQ(resumed->state(), of.stopped);
    }
    // The same condition, asked again of the same merger.
    const auto merger = make_merger(of.input);
    const StopCondition stop = stop_at_fraction(of.fraction, of.certified);
    for (int i = 0; i < 3; ++i) {
      EXPECT_EQ(run(*merger, stop), StopReason::kFractionOfMaximum);
      EXPECT_EQ(merger->state(), of.stopped);
    }
  }
}

TEST(StopAtFraction, IsTestedAtFixedNumbersThatGrow) {
  for (const std::uint64_t candidates : {0u, 1000u, 100000u}) {
    EXPECT_FALSE(is_fraction_test(0, candidates));
    std::uint64_t at = 0, tests = 0;
    for (int i = 0; i < 60; ++i) {
      const std::uint64_t next = next_fraction_test(at, candidates);
      ASSERT_GT(next, at);
      EXPECT_EQ(next_fraction_test(next - 1, candidates), next);
      EXPECT_TRUE(is_fraction_test(next, candidates));
      EXPECT_FALSE(is_fraction_test(next - 1, candidates));
      EXPECT_FALSE(is_fraction_test(next + 1, candidates));
      EXPECT_LE(next - at, std::max<std::uint64_t>({16, candidates / 256, at / 4 + 1}));
      tests += at <= candidates ? 1 : 0;
      at = next;
    }
    EXPECT_LE(tests, 40u) << "the tests of a large merge cost no more than a share of it";
  }
}

TEST(MemberTable, CountsByPairsOfMembers) {
  const std::vector<MergeMember> members = number_members({2, 2, 2, 1});
  const auto edge = [](std::uint32_t u, std::uint32_t v) {
    MergeEdge e;
    e.u = VertexId{u};
    e.v = VertexId{v};
    return e;
  };
  // 0 and 1 are joined twice at one vertex; 0 and 2 doubtfully; 1 and 2 not; nobody asked about 3 but 2.
  const std::vector<MergeEdge> edges{edge(0, 2), edge(0, 3), edge(1, 4)};
  const std::vector<RejectedPair> rejected{{.source = VertexId{5}, .target = VertexId{2}},
                                           {.source = VertexId{6}, .target = VertexId{4}}};
  const std::vector<bool> confirmed{true, true, false};
  const auto table = member_table(members, edges, rejected, confirmed, std::vector<bool>(6, true));
  ASSERT_EQ(table.size(), 6u);
  EXPECT_EQ(table[0], (MemberPairSummary{0, 1, 2, 2, 2, 1, JoinVerdict::kJoined}));
  EXPECT_EQ(table[1], (MemberPairSummary{0, 2, 1, 1, 0, 0, JoinVerdict::kAmbiguous}));
  EXPECT_EQ(table[2], (MemberPairSummary{0, 3, 0, 0, 0, 0, JoinVerdict::kNotJoined}));
  EXPECT_EQ(table[3], (MemberPairSummary{1, 2, 1, 0, 0, 0, JoinVerdict::kNotJoined}));
  EXPECT_EQ(table[5], (MemberPairSummary{2, 3, 1, 0, 0, 0, JoinVerdict::kNotJoined}));
  const std::vector<bool> none(6, false);
  EXPECT_EQ(member_table(members, edges, rejected, confirmed, none)[2].verdict, JoinVerdict::kUndecided);
  EXPECT_EQ(member_table(members, edges, rejected, {}, none)[1].confirmed, 1u) << "without a guard all are confirmed";
  // One pair may be finished while others are not.
  const auto part = member_table(members, edges, rejected, confirmed, {true, true, false, true, false, false});
  EXPECT_EQ(part[0].verdict, JoinVerdict::kJoined);
  EXPECT_EQ(part[1].verdict, JoinVerdict::kAmbiguous);
  EXPECT_EQ(part[2].verdict, JoinVerdict::kUndecided);
  EXPECT_EQ(part[3].verdict, JoinVerdict::kNotJoined);
  EXPECT_EQ(part[5].verdict, JoinVerdict::kUndecided);
}

}  // namespace
}  // namespace mapweld
