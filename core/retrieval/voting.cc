#include "core/retrieval/voting.h"

#include <algorithm>
#include <span>

namespace mapweld {
namespace {

// Counters of one thread, all zero between queries.
std::vector<std::uint32_t>& zeroed_counters(std::uint32_t vertices) {
  constexpr std::size_t kKeptAtMost = 1u << 21;  // 8 MB a thread; beyond, a query pays for its own
  thread_local std::vector<std::uint32_t> counters;
  if (counters.size() > kKeptAtMost && vertices <= kKeptAtMost) counters = {};
  if (counters.size() < vertices) counters.resize(vertices);
  return counters;
}

template <VoteRule kRule>
void add_votes(std::span<const Posting> postings, std::uint16_t count, std::uint32_t* counters) {
  for (const Posting& p : postings) counters[to_index(p.vertex)] += word_votes(count, p.count, kRule);
}

}  // namespace

std::vector<WordCount> count_words(const AppearanceVector& image) {
  std::vector<WordCount> counts;
  counts.reserve(image.appearances.size());
  for (const Appearance& a : image.appearances) {
    if (counts.empty() || counts.back().word != a.word) {
      counts.push_back({a.word, 1});
    } else if (counts.back().count < UINT16_MAX) {
      ++counts.back().count;
    }
  }
  return counts;
}

Votes vote(const AppearanceVector& query, const PostingSource& map, VoteRule rule, std::uint32_t min_votes) {
  Votes result;
  const std::uint32_t vertices = map.vertices();
  std::vector<std::uint32_t>& counters = zeroed_counters(vertices);
  std::vector<Posting> scratch;
  try {
    for (const WordCount& w : count_words(query)) {
      const std::span<const Posting> postings = map.view(w.word, scratch);
      if (postings.empty()) continue;
      ++result.known_words;
      if (rule == VoteRule::kProduct) {
        add_votes<VoteRule::kProduct>(postings, w.count, counters.data());
      } else {
        add_votes<VoteRule::kMin>(postings, w.count, counters.data());
      }
    }
  } catch (...) {
    std::fill_n(counters.begin(), vertices, 0);
    throw;
  }
  const std::uint32_t least = std::max<std::uint32_t>(min_votes, 1);
  for (std::uint32_t v = 0; v < vertices; ++v) {
    if (counters[v] >= least) result.candidates.push_back({VertexId{v}, counters[v]});
    counters[v] = 0;
  }
  std::ranges::sort(result.candidates, [](const VotedVertex& a, const VotedVertex& b) {
    return a.votes != b.votes ? a.votes > b.votes : a.vertex < b.vertex;
  });
  return result;
}

std::uint32_t pair_votes(const AppearanceVector& a, const AppearanceVector& b, VoteRule rule) {
  const std::vector<WordCount> of_a = count_words(a);
  const std::vector<WordCount> of_b = count_words(b);
  std::uint32_t votes = 0;
  for (auto i = of_a.begin(), j = of_b.begin(); i != of_a.end() && j != of_b.end();) {
    if (i->word < j->word) {
      ++i;
    } else if (j->word < i->word) {
      ++j;
    } else {
      votes += word_votes(i->count, j->count, rule);
      ++i;
      ++j;
    }
  }
  return votes;
}

}  // namespace mapweld
