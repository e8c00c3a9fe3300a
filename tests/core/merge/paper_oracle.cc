#include "tests/core/merge/paper_oracle.h"

#include <algorithm>
#include <iterator>
#include <map>
#include <set>
#include <tuple>
#include <utility>

#include "tests/core/retrieval/random_images.h"

namespace mapweld::test {
namespace {

struct Maps {
  std::vector<VertexId> m1, m2;
};

Maps by_size(const MergeInput& input) {
  std::vector<VertexId> first = input.members[0].vertices, second = input.members[1].vertices;
  if (first.size() < second.size()) return {second, first};
  return {first, second};
}

std::map<WordId, std::uint32_t> words_of(const MergeInput& input, VertexId v) {
  std::map<WordId, std::uint32_t> counts;
  for (const Appearance& a : input.appearances->appearances(v)->appearances) ++counts[a.word];
  return counts;
}

AppearanceVector only(const AppearanceVector& image, WordId word) {
  AppearanceVector part;
  std::ranges::copy_if(image.appearances, std::back_inserter(part.appearances),
                       [word](const Appearance& a) { return a.word == word; });
  return part;
}

std::uint32_t votes_for(const MergeInput& input, VertexId source, VertexId target, WordId word) {
  if (input.options.votes == VoteRule::kSignatures) {
    return votes_by_signatures(only(*input.appearances->appearances(source), word),
                               only(*input.appearances->appearances(target), word));
  }
  const std::uint32_t a = words_of(input, source)[word], b = words_of(input, target)[word];
  return input.options.votes == VoteRule::kMin ? std::min(a, b) : a * b;
}

std::uint32_t votes_for(const MergeInput& input, VertexId source, VertexId target) {
  std::uint32_t votes = 0;
  for (const auto& [word, count] : words_of(input, source)) votes += votes_for(input, source, target, word);
  return votes;
}

bool verify(const MergeInput& input, VertexId source, VertexId target) {
  return input.verifier->verify(*input.appearances->appearances(source), *input.appearances->appearances(target))
      .accepted;
}

}  // namespace

OracleRun quick_connect_by_the_paper(const MergeInput& input) {
  const auto [m1, m2] = by_size(input);
  OracleRun run;
  std::map<VertexId, std::set<VertexId>> neighbours;
  for (const Edge& e : input.inner_edges) {
    neighbours[e.u].insert(e.v);
    neighbours[e.v].insert(e.u);
  }
  const auto insert_edge = [&](VertexId source, VertexId target) {
    const bool accepted = verify(input, source, target);
    run.verdicts.push_back({source, target, votes_for(input, source, target), accepted});
    if (accepted) {
      neighbours[source].insert(target);
      neighbours[target].insert(source);
    }
    return accepted;
  };

  // W: priority of every word that is still in the queue.
  std::set<WordId> words_of_m1;
  for (const VertexId v : m1) {
    for (const auto& [word, count] : words_of(input, v)) words_of_m1.insert(word);
  }
  std::map<WordId, int> queue;
  for (const VertexId v : m2) {
    for (const auto& [word, count] : words_of(input, v)) {
      if (words_of_m1.contains(word)) queue[word] = 0;
    }
  }
  std::map<std::pair<VertexId, VertexId>, std::uint32_t> similarity;
  std::set<VertexId> processed;
  std::vector<std::pair<VertexId, VertexId>> postponed;
  while (!queue.empty()) {
    const auto top = std::max_element(queue.begin(), queue.end(), [](const auto& a, const auto& b) {
      return std::tuple(a.second, -static_cast<std::int64_t>(to_index(a.first))) <
             std::tuple(b.second, -static_cast<std::int64_t>(to_index(b.first)));
    });
    const WordId word = top->first;
    queue.erase(top);
    run.words.push_back(word);
    std::vector<std::tuple<std::int64_t, VertexId, VertexId>> fresh;  // (-votes, source, target)
    for (const VertexId source : m2) {
      for (const VertexId target : m1) {
        const std::uint32_t votes = votes_for(input, source, target, word);
        if (votes == 0) continue;
        std::uint32_t& cell = similarity[{source, target}];
        const std::uint32_t before = cell;
        cell += votes;
        if (before < input.options.min_votes && cell >= input.options.min_votes) {
          fresh.emplace_back(-static_cast<std::int64_t>(cell), source, target);
        }
      }
    }
    std::sort(fresh.begin(), fresh.end());
    for (const auto& [negative_votes, source, target] : fresh) {
      if (processed.contains(source)) {
        postponed.emplace_back(source, target);
      } else if (insert_edge(source, target)) {
        processed.insert(source);
        for (const auto& [w, count] : words_of(input, source)) {
          const auto queued = queue.find(w);
          if (queued != queue.end()) ++queued->second;
        }
      }
    }
  }
  run.explored = run.verdicts.size();
  std::vector<std::tuple<std::size_t, std::int64_t, VertexId, VertexId>> refinement;
  for (const auto& [source, target] : postponed) {
    refinement.emplace_back(std::min(neighbours[source].size(), neighbours[target].size()),
                            -static_cast<std::int64_t>(similarity[{source, target}]), source, target);
  }
  std::sort(refinement.begin(), refinement.end());
  for (const auto& [degree, negative_votes, source, target] : refinement) insert_edge(source, target);
  return run;
}

OracleRun brute_force_by_the_paper(const MergeInput& input) {
  const auto [m1, m2] = by_size(input);
  OracleRun run;
  for (const VertexId source : m2) {
    std::vector<std::pair<std::int64_t, VertexId>> candidates;
    for (const VertexId target : m1) {
      const std::uint32_t votes = votes_for(input, source, target);
      if (votes >= input.options.min_votes) candidates.emplace_back(-static_cast<std::int64_t>(votes), target);
    }
    std::sort(candidates.begin(), candidates.end());
    for (const auto& [negative_votes, target] : candidates) {
      run.verdicts.push_back(
          {source, target, static_cast<std::uint32_t>(-negative_votes), verify(input, source, target)});
    }
  }
  return run;
}

}  // namespace mapweld::test
