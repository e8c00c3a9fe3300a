#include "server/evaluation/candidate_verdicts.h"

#include <algorithm>
#include <cmath>
#include <mutex>
#include <tuple>

#include "core/geometry/portable_math.h"
#include "core/merge/vote_source.h"
#include "server/evaluation/parallel.h"

namespace mapweld::server::evaluation {

bool accepts(const CandidateVerdict& verdict, const VerifierOptions& thresholds) {
  return verdict.plausible && verdict.inliers >= std::max(thresholds.min_inliers, kFewestInliers) &&
         verdict.log10_false_alarms <= portable_log10(thresholds.max_false_alarms);
}

std::vector<CandidateVerdict> verify_candidates(const MergeInput& input, int threads,
                                                const std::function<void(std::uint64_t)>& progress) {
  const MemberPair pair = order_members(input.members);
  const std::vector<VertexId>& m1 = input.members[pair.m1].vertices;
  const std::vector<VertexId>& m2 = input.members[pair.m2].vertices;
  std::shared_ptr<const VoteSource> votes = input.votes;
  if (!votes) {
    votes = std::make_shared<WordVotes>(*input.appearances, input.members[pair.m1], input.members[pair.m2]);
  }
  std::vector<CandidateVerdict> verdicts;
  std::mutex mutex;
  parallel_for(votes->rows(), threads, [&](std::size_t row) {
    std::vector<std::uint32_t> row_votes;
    votes_of_row(*votes, static_cast<std::uint32_t>(row), input.options.votes, row_votes);
    std::vector<CandidateVerdict> of_row;
    for (std::uint32_t column = 0; column < row_votes.size(); ++column) {
      if (row_votes[column] < input.options.min_votes) continue;
      const VertexId u = std::min(m2[row], m1[column]), v = std::max(m2[row], m1[column]);
      const Verification verdict =
          input.verifier->verify(*input.appearances->appearances(u), *input.appearances->appearances(v));
      const auto number = static_cast<std::uint32_t>(row);
      of_row.push_back({pair.m1 == 0 ? column : number, pair.m1 == 0 ? number : column, row_votes[column],
                        verdict.inliers, verdict.log10_false_alarms, verdict.accepted});
    }
    const std::lock_guard lock(mutex);
    verdicts.insert(verdicts.end(), of_row.begin(), of_row.end());
    if (progress) progress(verdicts.size());
  });
  std::ranges::sort(verdicts, {}, [](const CandidateVerdict& v) { return std::tie(v.a, v.b); });
  return verdicts;
}

}  // namespace mapweld::server::evaluation
