// Any pair of a merge, explained: against the whole checkpoint, against pictures whose shift is known, and every
// refusal.
#include "server/services/pair_service.h"

#include <algorithm>
#include <map>
#include <set>

#include <gtest/gtest.h>

#include "client/contract/problem.h"
#include "schema/blobs/merge_state_blob.h"
#include "schema/maps/edge_store.h"
#include "schema/maps/map_store.h"
#include "schema/merges/merge_store.h"
#include "tests/core/retrieval/random_images.h"
#include "tests/server/jobs/stored_toy_maps.h"
#include "tests/server/services/pairs_of_walls.h"

namespace mapweld::test {
namespace {

using namespace std::chrono_literals;
using server::explain_pair;

// Votes counted the slow way.
std::uint32_t votes_by_hand(const AppearanceVector& a, const AppearanceVector& b, VoteRule rule) {
  if (rule == VoteRule::kSignatures) return votes_by_signatures(a, b);
  std::map<WordId, std::uint32_t> in_a, in_b;
  for (const Appearance& one : a.appearances) ++in_a[one.word];
  for (const Appearance& one : b.appearances) ++in_b[one.word];
  std::uint32_t votes = 0;
  for (const auto& [word, count] : in_a) {
    const auto found = in_b.find(word);
    if (found == in_b.end()) continue;
    votes += rule == VoteRule::kMin ? std::min(count, found->second) : count * found->second;
  }
  return votes;
}

// Every pair of the job's two members against the state in its checkpoint; how many there are of each verdict.
std::map<std::string, int> expect_as_in_checkpoint(Store& store, std::int64_t job, const ToyWorld& world) {
  const MergeInput input = make_toy_merge(world);
  const MergeState state = stored_state(store, job);
  const std::string merged = find_merge(store.read(), JobId{job})->map_name;
  std::map<std::string, int> verdicts;
  for (const VertexId u : input.members[0].vertices) {
    for (const VertexId v : input.members[1].vertices) {
      contract::Pair expected;
      expected.u = to_index(u);
      expected.v = to_index(v);
      expected.map = merged;
      expected.merge = job;
      expected.votes =
          votes_by_hand(*input.appearances->appearances(u), *input.appearances->appearances(v), world.votes);
      expected.verdict = expected.votes < world.min_votes ? "not_candidate" : "pending";
      if (expected.votes < world.min_votes) expected.reason = "no_candidate";
      for (const MergeEdge& edge : state.edges) {
        if (edge.u != u || edge.v != v) continue;
        expected.verdict = "accepted";
        expected.confirmed = true;  // a job without a guard
        expected.matches = edge.verification.matches;
        expected.inliers = edge.verification.inliers;
      }
      for (const RejectedPair& pair : state.rejected) {
        if (std::minmax(pair.source, pair.target) != std::minmax(u, v)) continue;
        expected.verdict = "rejected";
        expected.matches = pair.matches;
        expected.inliers = pair.inliers;
        expected.reason = std::string(to_string(pair.reason));
      }
      EXPECT_EQ(explain_pair(store, job, to_index(u), to_index(v), false), expected);
      EXPECT_EQ(explain_pair(store, job, to_index(v), to_index(u), false), expected);
      ++verdicts[expected.verdict];
    }
  }
  return verdicts;
}

TEST(PairsOfAJob, AreAsItsCheckpointHasThem) {
  std::map<std::string, int> verdicts;
  for (const char* method : {"quickconnect", "brute-force"}) {
    for (const std::uint32_t seed : {0u, 2u, 5u, 19u, 20u}) {
      ToyWorld world = toy_world(seed);
      world.method = method;
      TempStore store;
      store_toy_maps(store, world);
      server::MergeJobs jobs(store, job_options(std::make_shared<HashVerifier>(world.accept_share)));
      jobs.start();
      server::MergeRequest request = request_of(world);
      request.budget.verifications = 7;
      const std::int64_t job = jobs.submit(request).id;
      jobs.wait(job, 30s);
      for (const auto& [verdict, count] : expect_as_in_checkpoint(store, job, world)) verdicts[verdict] += count;
      if (jobs.get(job).state != JobState::kBudgetExhausted) continue;
      jobs.resume(job, std::nullopt);
      ASSERT_EQ(jobs.wait(job, 30s).state, JobState::kCompleted);
      EXPECT_EQ(expect_as_in_checkpoint(store, job, world)["pending"], 0);
    }
  }
  for (const char* verdict : {"accepted", "rejected", "pending", "not_candidate"}) EXPECT_GT(verdicts[verdict], 0);
}

TEST(PairsOfAJob, AreFoundOnAnyPageOfTheRejected) {
  const ToyWorld world = toy_world(19);
  TempStore store;
  store_toy_maps(store, world);
  server::MergeJobs jobs(store, job_options(std::make_shared<HashVerifier>(world.accept_share)));  // never started
  const std::int64_t job = jobs.submit(request_of(world)).id;
  // Three candidates, put at the ends of pages among thousands of pairs that are not asked for.
  const MergeInput input = make_toy_merge(world);
  std::vector<std::pair<VertexId, VertexId>> candidates;
  for (const VertexId u : input.members[0].vertices) {
    for (const VertexId v : input.members[1].vertices) {
      const auto votes =
          votes_by_hand(*input.appearances->appearances(u), *input.appearances->appearances(v), world.votes);
      if (votes >= world.min_votes) candidates.emplace_back(u, v);
    }
  }
  ASSERT_GT(candidates.size(), 3u);
  MergeState state;
  state.method = world.method;
  state.rejected.resize(2 * blobs::kRejectedPerPage + 9,
                        {VertexId{90'000}, VertexId{90'001}, Reason::kTooFewInliers, 1, 1});
  const std::size_t places[] = {0, blobs::kRejectedPerPage, state.rejected.size() - 1};
  for (std::uint16_t i = 0; i < 3; ++i) {
    state.rejected[places[i]] = {candidates[i].second, candidates[i].first, Reason::kInconsistent, 40, i};
  }
  const std::vector<blobs::MergeStatePart> encoded = blobs::encode_merge_state(state, std::nullopt);
  std::vector<CheckpointPart> parts;
  for (const blobs::MergeStatePart& part : encoded) {
    // The lookup leaves the rest of the checkpoint alone: it would not notice that it is damaged.
    if (part.name != "similarity") parts.push_back({part.name, part.bytes});
  }
  {
    WriteTransaction db = store.write();
    const std::uint64_t epoch = claim_merge(db, JobId{job}, at(0)).value();
    CheckpointWrite checkpoint;
    checkpoint.phase = "exploration";
    checkpoint.parts = parts;
    ASSERT_TRUE(save_checkpoint(db, JobId{job}, epoch, checkpoint));
    db.commit();
  }
  for (int i = 0; i < 4; ++i) {
    const contract::Pair pair = explain_pair(store, job, to_index(candidates[static_cast<std::size_t>(i)].first),
                                             to_index(candidates[static_cast<std::size_t>(i)].second), false);
    EXPECT_EQ(pair.verdict, i < 3 ? "rejected" : "pending") << i;
    if (i < 3) {
      EXPECT_EQ(pair.reason, "inconsistent");
      EXPECT_EQ(pair.matches, 40);
      EXPECT_EQ(pair.inliers, i);
    }
  }
  WriteTransaction db = store.write();
  db.connection().execute("UPDATE checkpoints SET bytes = x'00' WHERE part = 'rejected-000002'");
  db.commit();
  EXPECT_EQ(explain_pair(store, job, to_index(candidates[0].first), to_index(candidates[0].second), false).verdict,
            "rejected");
  EXPECT_THROW(explain_pair(store, job, to_index(candidates[3].first), to_index(candidates[3].second), false),
               StoreError);
}

TEST_F(PairsOfWalls, AnEdgeComesWithTheMatchesThatHeld) {
  const std::int64_t id = merge({"a", "b"}, "ab");
  const std::string stored = dump_store(services_.store());
  const auto edges = services_.merges().edges(id, {});
  ASSERT_FALSE(edges.items.empty());
  for (const contract::MergeEdge& edge : edges.items) {
    const auto u = static_cast<std::uint32_t>(edge.u), v = static_cast<std::uint32_t>(edge.v);
    const contract::Pair pair = explain(id, v, u);
    EXPECT_EQ(pair, explain(id, u, v));
    EXPECT_EQ(pair.u, edge.u);
    EXPECT_EQ(pair.v, edge.v);
    EXPECT_EQ(pair.votes, edge.votes);
    EXPECT_EQ(pair.inliers, edge.inliers);
    EXPECT_GE(pair.matches, pair.inliers);
    EXPECT_EQ(pair.verdict, "accepted");
    EXPECT_EQ(pair.reason, std::nullopt);
    EXPECT_NE(pair.kind, "none");
    EXPECT_LT(pair.log10_false_alarms, -6);
    EXPECT_EQ(static_cast<int>(pair.inlier_matches.value().size()), edge.inliers);
    expect_one_wall(pair, static_cast<int>(u), static_cast<int>(v) - kSteps + 2);
    const contract::Pair short_answer = explain(id, u, v, false);
    EXPECT_EQ(short_answer.inliers, pair.inliers);
    EXPECT_FALSE(contract::Json(short_answer).contains("inlier_matches"));
    EXPECT_FALSE(contract::Json(short_answer).contains("kind"));
  }
  EXPECT_EQ(dump_store(services_.store()), stored);
}

TEST_F(PairsOfWalls, WithoutAVerdictTheVerifierIsAskedForTheMatchesAlone) {
  const std::int64_t whole = merge({"a", "b"}, "ab");
  const std::int64_t begun = merge({"a", "b"}, "begun", 1);
  const std::string stored = dump_store(services_.store());
  int pending = 0;
  for (const contract::MergeEdge& edge : services_.merges().edges(whole, {}).items) {
    const auto u = static_cast<std::uint32_t>(edge.u), v = static_cast<std::uint32_t>(edge.v);
    contract::Pair pair = explain(begun, u, v, false);
    if (pair.verdict != "pending") continue;
    ++pending;
    EXPECT_EQ(pair.reason, std::nullopt);
    EXPECT_EQ(pair.matches, std::nullopt);
    EXPECT_EQ(pair.inliers, std::nullopt);
    pair = explain(begun, u, v);
    EXPECT_EQ(pair.verdict, "pending");
    contract::Pair verified = explain(whole, u, v);
    verified.map = "begun";
    verified.merge = begun;
    verified.verdict = "pending";
    verified.confirmed.reset();
    verified.confidence.reset();
    verified.min_confidence.reset();
    verified.evidence.reset();
    EXPECT_EQ(pair, verified);
  }
  EXPECT_GT(pending, 0);
  EXPECT_EQ(dump_store(services_.store()), stored);
}

TEST_F(PairsOfWalls, OfDifferentWallsHaveNoEdgeForAReason) {
  const std::int64_t id = merge({"a", "c"}, "ac");
  ASSERT_EQ(services_.merges().get(id).edges, 0);
  std::set<std::string> verdicts;
  for (std::uint32_t u = 0; u < kSteps; ++u) {
    for (std::uint32_t v = kSteps; v < 2 * kSteps; ++v) {
      const contract::Pair pair = explain(id, u, v);
      verdicts.insert(pair.verdict);
      EXPECT_TRUE(pair.reason);
      EXPECT_TRUE(pair.matches && pair.inliers && pair.kind && pair.log10_false_alarms && pair.inlier_matches);
      if (pair.verdict == "not_candidate") {
        EXPECT_EQ(pair.reason, "no_candidate");
        EXPECT_EQ(explain(id, u, v, false).matches, std::nullopt);
      } else {
        EXPECT_EQ(pair.verdict, "rejected");
        EXPECT_NE(pair.reason, "no_candidate");
        EXPECT_EQ(explain(id, u, v, false).matches, pair.matches);
      }
    }
  }
  EXPECT_TRUE(verdicts.contains("rejected"));
}

TEST_F(PairsOfWalls, BlankImagesAreNoCandidates) {
  services_.upload("a", "blank", jpeg(blank()));
  services_.upload("b", "blank", jpeg(blank()));
  const std::int64_t id = merge({"a", "b"}, "ab");
  const contract::Pair pair = explain(id, 4, 9);
  EXPECT_EQ(pair.votes, 0);
  EXPECT_EQ(pair.verdict, "not_candidate");
  EXPECT_EQ(pair.inliers, 0);
  EXPECT_TRUE(pair.inlier_matches.value().empty());
  EXPECT_EQ(pair.kind, "none");
}

TEST_F(PairsOfWalls, AreNumberedAsTheMergedMapOfMergedMapsIs) {
  merge({"a", "c"}, "ac");
  const std::int64_t id = merge({"ac", "b"}, "acb");    // a 0-3, c 4-7, b 8-11
  const contract::Pair same_place = explain(id, 2, 8);  // a's third image and b's first are the same
  EXPECT_EQ(same_place.verdict, "accepted");
  expect_one_wall(same_place, 2, 2);
  const contract::Pair neighbours = explain(id, 9, 2);
  EXPECT_EQ(neighbours.verdict, "accepted");
  expect_one_wall(neighbours, 2, 3);
  EXPECT_NE(explain(id, 5, 9).verdict, "accepted");
  EXPECT_EQ(neighbours.map, "acb");
  EXPECT_EQ(neighbours.merge, id);
  // a and c are one member here: what became of them in their own merge.
  const contract::Pair of_another = explain(id, 1, 5);
  EXPECT_EQ(of_another.map, "ac");
  EXPECT_EQ(of_another.merge, 1);
  EXPECT_EQ(of_another, explain(1, 1, 5));
}

TEST_F(PairsOfWalls, RefusesWhatIsNoPairOfTheMerge) {
  const std::int64_t id = merge({"a", "b"}, "ab");
  EXPECT_EQ(code(id + 7, 0, 4), "no_such_merge");
  EXPECT_EQ(code(id, 0, 8), "no_such_vertex");
  EXPECT_EQ(code(id, 4'000'000'000u, 0), "no_such_vertex");
  EXPECT_EQ(code(id, 0, 0), "invalid_parameter");
  EXPECT_EQ(code(id, 3, 4), "none");
  services_.merges().remove(id);
  EXPECT_EQ(code(id, 3, 4), "no_such_merge");
}

TEST_F(PairsOfWalls, BeyondTheWatermarkThereIsNoPair) {
  const std::int64_t id = merge({"a", "b"}, "ab");
  const contract::Pair before = explain(id, 2, 4);
  services_.upload("a", "a-4", photo_jpeg(1, 4));
  services_.upload("b", "b-4", photo_jpeg(1, 6));
  EXPECT_EQ(explain(id, 2, 4), before);
  EXPECT_EQ(code(id, 0, 8), "no_such_vertex");
  EXPECT_EQ(code(id, 8, 9), "no_such_vertex");
}

TEST_F(PairsOfWalls, AnEdgeThatIsNotConfirmedSaysSo) {
  const std::int64_t id = merge({"a", "b"}, "ab");
  {
    WriteTransaction db = services_.store().write();
    const MapId map = find_map(db, "ab")->id;
    ASSERT_TRUE(find_own_edge(db, map, VertexId{2}, VertexId{4}));
    set_judgements(db, map,
                   std::vector<JudgedEdge>{
                       {VertexId{2},
                        VertexId{4},
                        {0.25, Reason::kAmbiguous, {{"rare_matches", 3, -1.5}, {"of_yesterday", 0.5, std::nullopt}}}},
                       {VertexId{3}, VertexId{4}, {}}});
    db.commit();
  }
  const contract::Pair pair = explain(id, 2, 4);
  EXPECT_EQ(pair.verdict, "accepted");
  EXPECT_EQ(pair.reason, "ambiguous");
  EXPECT_EQ(pair.confirmed, false);
  EXPECT_EQ(pair.confidence, 0.25);
  // What it is made of is told as it was stored, names that nobody knows any more too.
  ASSERT_EQ(pair.evidence.value().size(), 2u);
  EXPECT_EQ(pair.evidence->front().name, "rare_matches");
  EXPECT_EQ(pair.evidence->front().value, 3);
  EXPECT_EQ(pair.evidence->front().weight, -1.5);
  EXPECT_EQ(pair.evidence->front().says, evidence_says("rare_matches"));
  EXPECT_EQ(pair.evidence->back().name, "of_yesterday");
  EXPECT_EQ(pair.evidence->back().weight, std::nullopt);
  EXPECT_EQ(pair.evidence->back().says, "");
  // An edge that nobody has judged is confirmed, and a pair without one is neither.
  const contract::Pair unjudged = explain(id, 3, 4);
  EXPECT_EQ(unjudged.verdict, "accepted");
  EXPECT_EQ(unjudged.confirmed, true);
  EXPECT_EQ(unjudged.confidence, std::nullopt);
  EXPECT_EQ(unjudged.evidence, std::nullopt);
  EXPECT_EQ(explain(id, 0, 7).confirmed, std::nullopt);
}

}  // namespace
}  // namespace mapweld::test
