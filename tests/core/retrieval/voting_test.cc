#include "core/retrieval/voting.h"

#include <algorithm>
#include <random>
#include <set>
#include <stdexcept>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "tests/core/retrieval/random_images.h"

namespace mapweld {
namespace {

// S by the paper's definition: every pair of features, one by one (section III-A); for kMin, matching off equal words.
std::uint32_t votes_by_pairs(const AppearanceVector& a, const AppearanceVector& b, VoteRule rule) {
  if (rule == VoteRule::kSignatures) return test::votes_by_signatures(a, b);
  std::uint32_t votes = 0;
  std::vector<bool> taken(b.appearances.size(), false);
  for (const Appearance& p : a.appearances) {
    for (std::size_t j = 0; j < b.appearances.size(); ++j) {
      if (b.appearances[j].word != p.word) continue;
      if (rule == VoteRule::kMin && taken[j]) continue;
      ++votes;
      if (rule == VoteRule::kMin) {
        taken[j] = true;
        break;
      }
    }
  }
  return votes;
}

std::vector<VotedVertex> votes_by_scan(const AppearanceVector& query, const std::vector<AppearanceVector>& map,
                                       VoteRule rule, std::uint32_t min_votes) {
  std::vector<VotedVertex> all;
  for (std::size_t v = 0; v < map.size(); ++v) {
    const std::uint32_t votes = votes_by_pairs(query, map[v], rule);
    if (votes > 0 && votes >= min_votes) all.push_back({VertexId{static_cast<std::uint32_t>(v)}, votes});
  }
  std::ranges::stable_sort(all, [](const VotedVertex& a, const VotedVertex& b) { return a.votes > b.votes; });
  return all;
}

InvertedIndex index_of(const std::vector<AppearanceVector>& map) {
  InvertedIndex index;
  for (const AppearanceVector& image : map) index.add(image);
  return index;
}

class VotingByRule : public testing::TestWithParam<VoteRule> {};
INSTANTIATE_TEST_SUITE_P(Rules, VotingByRule,
                         testing::Values(VoteRule::kMin, VoteRule::kProduct, VoteRule::kSignatures));

TEST_P(VotingByRule, VotesOfAPairAreCountedOneByOne) {
  const auto map = test::random_map(11, 40, 60, 60);
  for (const AppearanceVector& a : map) {
    for (const AppearanceVector& b : map) {
      EXPECT_EQ(pair_votes(a, b, GetParam()), votes_by_pairs(a, b, GetParam()));
      EXPECT_EQ(pair_votes(a, b, GetParam()), pair_votes(b, a, GetParam()));
    }
  }
}

TEST_P(VotingByRule, VotesOverTheMapEqualVotesOfPairs) {
  const auto map = test::random_map(12, 150, 80, 50);
  const InvertedIndex index = index_of(map);
  for (const AppearanceVector& query : test::random_map(13, 30, 80, 50)) {
    for (const std::uint32_t min_votes : {0u, 1u, 7u, 20u, 10000u}) {
      EXPECT_EQ(vote(query, index, GetParam(), min_votes).candidates, votes_by_scan(query, map, GetParam(), min_votes));
    }
  }
}

TEST_P(VotingByRule, ThreadsWithMapsOfDifferentSizesDoNotDisturbEachOther) {
  const auto small = test::random_map(14, 20, 80, 50);
  const auto large = test::random_map(15, 300, 80, 50);
  const InvertedIndex small_index = index_of(small);
  const InvertedIndex large_index = index_of(large);
  const auto queries = test::random_map(16, 20, 80, 50);
  std::vector<std::thread> threads;
  std::vector<int> wrong(4, 0);
  for (std::size_t t = 0; t < wrong.size(); ++t) {
    threads.emplace_back([&, t] {
      for (const AppearanceVector& query : queries) {
        wrong[t] += vote(query, large_index, GetParam(), 3).candidates != votes_by_scan(query, large, GetParam(), 3);
        wrong[t] += vote(query, small_index, GetParam(), 3).candidates != votes_by_scan(query, small, GetParam(), 3);
      }
    });
  }
  for (std::thread& t : threads) t.join();
  EXPECT_EQ(wrong, std::vector<int>(4, 0));
}

TEST(Voting, SignaturesBoundMinVotesAndMinVotesProductVotes) {
  const auto map = test::random_map(17, 30, 40, 60);
  for (const AppearanceVector& a : map) {
    for (const AppearanceVector& b : map) {
      EXPECT_LE(pair_votes(a, b, VoteRule::kSignatures), pair_votes(a, b, VoteRule::kMin));
      EXPECT_LE(pair_votes(a, b, VoteRule::kMin), pair_votes(a, b, VoteRule::kProduct));
      EXPECT_LE(pair_votes(a, b, VoteRule::kMin), std::min(a.appearances.size(), b.appearances.size()));
    }
  }
}

TEST(Voting, KnownWordsAreDistinctWordsOfTheMap) {
  const auto map = test::random_map(18, 5, 200, 30);
  const InvertedIndex index = index_of(map);
  std::set<WordId> of_map;
  for (const AppearanceVector& image : map) {
    for (const Appearance& a : image.appearances) of_map.insert(a.word);
  }
  for (const AppearanceVector& query : test::random_map(19, 20, 200, 60)) {
    std::set<WordId> known;
    for (const Appearance& a : query.appearances) {
      if (of_map.contains(a.word)) known.insert(a.word);
    }
    EXPECT_EQ(vote(query, index, VoteRule::kMin, 1).known_words, known.size());
  }
}

TEST(Voting, CountsSaturate) {
  AppearanceVector texture{.width_px = 320, .height_px = 240, .appearances = {}};
  texture.appearances.assign(70000, {.word = WordId{5}});
  const AppearanceVector one{.width_px = 320, .height_px = 240, .appearances = {{.word = WordId{5}}}};
  EXPECT_EQ(pair_votes(texture, texture, VoteRule::kMin), 65535u);
  EXPECT_EQ(pair_votes(texture, one, VoteRule::kProduct), 65535u);
  EXPECT_EQ(pair_votes(texture, one, VoteRule::kSignatures), 1u);
}

// Vertices whose postings are many thousands, in more pieces than are compared at a time, and cut anywhere.
TEST(Voting, LongListsVoteAsShortOnes) {
  std::mt19937_64 random(21);
  const WordId word{3};
  const auto image_of = [&](int features) {
    AppearanceVector image{.width_px = 320, .height_px = 240, .appearances = {}};
    for (int f = 0; f < features; ++f) {
      image.appearances.push_back({word, static_cast<float>(f), 0, 4, 0, test::signature_for(word, random)});
    }
    return image;
  };
  std::vector<AppearanceVector> map;
  for (int v = 0; v < 4000; ++v) map.push_back(image_of(v == 1000 ? 5000 : static_cast<int>(random() % 5)));
  const InvertedIndex index = index_of(map);
  for (const int features : {1, 2, 7}) {
    const AppearanceVector query = image_of(features);
    EXPECT_EQ(vote(query, index, VoteRule::kSignatures, 1).candidates,
              votes_by_scan(query, map, VoteRule::kSignatures, 1));
  }
}

TEST(Voting, EmptyQueryAndEmptyMapHaveNoCandidates) {
  InvertedIndex index;
  EXPECT_TRUE(vote({}, index, VoteRule::kMin, 0).candidates.empty());
  index.add({});
  EXPECT_TRUE(vote({}, index, VoteRule::kMin, 0).candidates.empty());
}

// A store that cannot be read in the middle of a query.
class BrokenSource final : public PostingSource {
 public:
  void visit(WordId word, const Visitor& visitor) const override {
    if (to_index(word) >= 10) throw std::runtime_error("disk");
    PostingList one;
    one.add(VertexId{0}, 0);
    visitor({one, 0});
  }
  std::uint32_t vertices() const override { return 3; }
};

TEST(Voting, AFailedQueryLeavesNothingForTheNext) {
  const auto map = test::random_map(20, 3, 40, 60);
  const InvertedIndex index = index_of(map);
  AppearanceVector query;
  for (std::uint32_t w = 0; w < 20; ++w) query.appearances.push_back({.word = WordId{w}});
  EXPECT_THROW(vote(query, BrokenSource{}, VoteRule::kMin, 1), std::runtime_error);
  EXPECT_EQ(vote(query, index, VoteRule::kMin, 1).candidates, votes_by_scan(query, map, VoteRule::kMin, 1));
}

}  // namespace
}  // namespace mapweld
