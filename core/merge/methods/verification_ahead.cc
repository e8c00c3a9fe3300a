#include "core/merge/methods/verification_ahead.h"

#include <algorithm>
#include <exception>
#include <optional>
#include <utility>

#include "core/merge/executor.h"

namespace mapweld {

Verification VerificationAhead::take(VertexId u, VertexId v, const Upcoming& upcoming) {
  auto found = verdicts_.find(pair_key(u, v));
  if (found == verdicts_.end() && input_.executor && input_.executor->concurrency() > 1) {
    verify_batch(u, v, upcoming);
    found = verdicts_.find(pair_key(u, v));
  }
  if (found == verdicts_.end()) return verify(u, v);
  Verification verdict = std::move(found->second);
  verdicts_.erase(found);
  return verdict;
}

std::shared_ptr<const PreparedImage> VerificationAhead::prepared(VertexId vertex) {
  if (const auto found = prepared_.find(vertex); found != prepared_.end()) return found->second;
  if (prepared_.size() >= kMostPrepared) prepared_.clear();
  return prepared_.emplace(vertex, input_.verifier->prepare(input_.appearances->appearances(vertex))).first->second;
}

Verification VerificationAhead::verify(VertexId u, VertexId v) {
  const std::shared_ptr<const PreparedImage> of_u = prepared(u), of_v = prepared(v);
  return input_.verifier->verify_prepared(*of_u, *of_v);
}

void VerificationAhead::verify_batch(VertexId u, VertexId v, const Upcoming& upcoming) {
  if (verdicts_.size() > kMostKept) verdicts_.clear();
  candidates_.assign(1, {u, v, 0});
  upcoming(kBatch + 1, candidates_);  // the pair itself is most often among them
  struct Asked {
    std::uint64_t key = 0;
    std::shared_ptr<const PreparedImage> of_u, of_v;
    std::optional<Verification> verdict;
  };
  std::vector<Asked> batch;
  for (const Candidate& c : candidates_) {
    const std::uint64_t key = pair_key(c.source, c.target);
    const bool is_new = !verdicts_.contains(key) && std::ranges::find(batch, key, &Asked::key) == batch.end();
    if (!is_new || batch.size() == kBatch) continue;
    Asked asked{.key = key, .of_u = nullptr, .of_v = nullptr, .verdict = std::nullopt};
    try {
      asked.of_u = prepared(std::min(c.source, c.target));
      asked.of_v = prepared(std::max(c.source, c.target));
    } catch (const std::exception&) {
      continue;  // its own turn will tell
    }
    batch.push_back(std::move(asked));
  }
  if (batch.size() < 2) return;
  input_.executor->run(batch.size(), [&](std::size_t i) {
    try {
      batch[i].verdict = input_.verifier->verify_prepared(*batch[i].of_u, *batch[i].of_v);
    } catch (const std::exception&) {
      // Its own turn will tell.
    }
  });
  for (Asked& asked : batch) {
    if (asked.verdict) verdicts_.emplace(asked.key, std::move(*asked.verdict));
  }
}

}  // namespace mapweld
