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

Verification VerificationAhead::verify(VertexId u, VertexId v) const {
  return input_.verifier->verify(*input_.appearances->appearances(u), *input_.appearances->appearances(v));
}

void VerificationAhead::verify_batch(VertexId u, VertexId v, const Upcoming& upcoming) {
  if (verdicts_.size() > kMostKept) verdicts_.clear();
  candidates_.assign(1, {u, v, 0});
  upcoming(kBatch + 1, candidates_);  // the pair itself is most often among them
  std::vector<std::uint64_t> keys;
  for (const Candidate& c : candidates_) {
    const std::uint64_t key = pair_key(c.source, c.target);
    const bool is_new = !verdicts_.contains(key) && std::ranges::find(keys, key) == keys.end();
    if (is_new && keys.size() < kBatch) keys.push_back(key);
  }
  if (keys.size() < 2) return;
  std::vector<std::optional<Verification>> verdicts(keys.size());
  input_.executor->run(keys.size(), [&](std::size_t i) {
    try {
      verdicts[i] =
          verify(VertexId{static_cast<std::uint32_t>(keys[i] >> 32)}, VertexId{static_cast<std::uint32_t>(keys[i])});
    } catch (const std::exception&) {
      // Its own turn will tell.
    }
  });
  for (std::size_t i = 0; i < keys.size(); ++i) {
    if (verdicts[i]) verdicts_.emplace(keys[i], std::move(*verdicts[i]));
  }
}

}  // namespace mapweld
