#include "core/merge/spectral/quickconnect_draw.h"

#include <algorithm>
#include <utility>

namespace mapweld {
namespace {

constexpr std::uint32_t kMost = 0xFFFF;  // degree, votes
constexpr std::uint64_t kNotTheBest = std::uint64_t{1} << 32, kJoined = std::uint64_t{1} << 33;

// Keys in order, each with a range of them: first by group, which is the class or, of joined sources, the degree, then
// by votes.
constexpr std::uint32_t kGroups = 256, kVotes = 1024;
std::uint32_t bucket_of(std::uint64_t key) {
  const auto kind = static_cast<std::uint32_t>(key >> 32), degree = static_cast<std::uint32_t>(key >> 16) & kMost;
  const std::uint32_t votes = kMost - (static_cast<std::uint32_t>(key) & kMost);
  const std::uint32_t group = kind < 2 ? kind : 2 + std::min(degree, kGroups - 3);
  return group * kVotes + (kVotes - 1 - std::min(votes, kVotes - 1));
}

}  // namespace

std::vector<std::uint32_t> draw_quickconnect(const CandidateEvidence& evidence, const AppearanceGraph& graph,
                                             std::span<const std::uint8_t> is_joined, std::span<const VertexId> sources,
                                             std::span<const VertexId> targets, std::size_t count) {
  std::vector<std::uint32_t> best_of(graph.vertices(), evidence.size());  // of each source that is not joined
  for (std::uint32_t row = 0; row < evidence.rows(); ++row) {
    if (is_joined[to_index(sources[row])] != 0) continue;
    std::uint32_t& best = best_of[to_index(sources[row])];
    for (std::uint32_t c = evidence.first_of(row); c < evidence.first_of(row + 1); ++c) {
      if (!evidence.is_open(c)) continue;
      if (best == evidence.size() || evidence.cell(c).votes > evidence.cell(best).votes) best = c;
    }
  }
  std::vector<std::uint64_t> degrees(graph.vertices());
  for (std::uint32_t v = 0; v < graph.vertices(); ++v) degrees[v] = std::min(graph.degree(VertexId{v}), kMost);

  // Ascending (class and degree, votes descending).
  const auto for_each_key = [&](const auto& act) {
    for (std::uint32_t row = 0; row < evidence.rows(); ++row) {
      const std::uint32_t u = to_index(sources[row]);
      for (std::uint32_t c = evidence.first_of(row); c < evidence.first_of(row + 1); ++c) {
        if (!evidence.is_open(c)) continue;
        std::uint64_t key = kMost - std::min(evidence.cell(c).votes, kMost);
        if (is_joined[u] != 0) {
          key |= kJoined | std::min(degrees[u], degrees[to_index(targets[evidence.cell(c).column])]) << 16;
        } else if (c != best_of[u]) {
          key |= kNotTheBest;
        }
        act(key, c);
      }
    }
  };
  std::uint32_t last = kGroups * kVotes - 1;  // bucket
  if (count < evidence.open()) {
    std::vector<std::uint32_t> in_bucket(kGroups * kVotes);
    for_each_key([&](std::uint64_t key, std::uint32_t) { ++in_bucket[bucket_of(key)]; });
    last = 0;
    for (std::size_t until = in_bucket[0]; until < count; until += in_bucket[last]) ++last;
  }
  std::vector<std::pair<std::uint64_t, std::uint32_t>> keys;
  for_each_key([&](std::uint64_t key, std::uint32_t c) {
    if (bucket_of(key) <= last) keys.emplace_back(key, c);
  });
  if (count < keys.size()) {
    std::nth_element(keys.begin(), keys.begin() + static_cast<std::ptrdiff_t>(count), keys.end());
    keys.resize(count);
  }
  std::ranges::sort(keys);
  std::vector<std::uint32_t> drawn;
  drawn.reserve(keys.size());
  for (const auto& [key, c] : keys) drawn.push_back(c);
  return drawn;
}

}  // namespace mapweld
