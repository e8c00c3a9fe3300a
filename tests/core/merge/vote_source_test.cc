#include "core/merge/vote_source.h"

#include <map>
#include <set>

#include <gtest/gtest.h>

#include "tests/core/merge/toy_maps.h"
#include "tests/core/retrieval/random_images.h"

namespace mapweld {
namespace {

std::map<WordId, std::uint32_t> count_words_of(const MergeInput& input, VertexId v) {
  std::map<WordId, std::uint32_t> counts;
  for (const Appearance& a : input.appearances->appearances(v)->appearances) ++counts[a.word];
  return counts;
}

TEST(WordVotes, HoldsTheWordsThatBothMapsHave) {
  for (std::uint32_t seed = 0; seed < 20; ++seed) {
    const MergeInput input = make_toy_merge(test::toy_world(seed));
    const MemberPair pair = order_members(input.members);
    const MergeMember &m1 = input.members[pair.m1], &m2 = input.members[pair.m2];
    const WordVotes votes(*input.appearances, m1, m2);
    EXPECT_EQ(votes.rows(), m2.vertices.size());
    EXPECT_EQ(votes.columns(), m1.vertices.size());

    std::set<WordId> in_m1, shared;
    for (const VertexId v : m1.vertices) {
      for (const auto& [word, count] : count_words_of(input, v)) in_m1.insert(word);
    }
    for (const VertexId v : m2.vertices) {
      for (const auto& [word, count] : count_words_of(input, v)) {
        if (in_m1.contains(word)) shared.insert(word);
      }
    }
    ASSERT_EQ(std::vector<WordId>(votes.words().begin(), votes.words().end()),
              std::vector<WordId>(shared.begin(), shared.end()));

    for (std::uint32_t w = 0; w < votes.words().size(); ++w) {
      for (const bool is_row : {true, false}) {
        const MergeMember& member = is_row ? m2 : m1;
        PostingList expected, actual;
        for (std::uint32_t i = 0; i < member.vertices.size(); ++i) {
          for (const Appearance& a : input.appearances->appearances(member.vertices[i])->appearances) {
            if (a.word == votes.words()[w]) expected.add(VertexId{i}, vote_signature(a.signature));
          }
        }
        actual.append(is_row ? votes.row_postings(w) : votes.column_postings(w));
        EXPECT_EQ(actual, expected);
      }
    }
    for (std::uint32_t row = 0; row < votes.rows(); ++row) {
      std::vector<std::pair<WordId, std::uint32_t>> expected, actual;
      for (const auto& [word, count] : count_words_of(input, m2.vertices[row])) {
        if (shared.contains(word)) expected.emplace_back(word, count);
      }
      for (const VoteSource::RowWord& w : votes.row_words(row)) {
        actual.emplace_back(votes.words()[w.word], w.count);
      }
      std::vector<VoteSignature> signatures;
      for (const Appearance& a : input.appearances->appearances(m2.vertices[row])->appearances) {
        if (shared.contains(a.word)) signatures.push_back(vote_signature(a.signature));
      }
      EXPECT_TRUE(std::ranges::equal(votes.row_signatures(row), signatures));
      EXPECT_EQ(actual, expected);
    }
  }
}

TEST(WordVotes, GivesTheVotesOfThePaper) {
  const MergeInput input = make_toy_merge(test::toy_world(19));
  const WordVotes votes(*input.appearances, input.members[0], input.members[1]);
  std::vector<std::uint32_t> row_votes;
  std::uint32_t greatest = 0;
  for (std::uint32_t row = 0; row < votes.rows(); ++row) {
    for (const VoteRule rule : {VoteRule::kMin, VoteRule::kProduct}) {
      votes_of_row(votes, row, rule, row_votes);
      for (std::uint32_t column = 0; column < votes.columns(); ++column) {
        // The double sum of section III-A: every pair of features with the same word votes once.
        std::uint32_t pairs = 0, one_to_one = 0;
        auto a = count_words_of(input, input.members[1].vertices[row]);
        auto b = count_words_of(input, input.members[0].vertices[column]);
        for (const auto& [word, count] : a) {
          pairs += count * b[word];
          one_to_one += std::min(count, b[word]);
        }
        const std::uint32_t expected = rule == VoteRule::kMin ? one_to_one : pairs;
        EXPECT_EQ(row_votes[column], expected);
        EXPECT_EQ(votes_of_pair(votes, row, column, rule), expected);
        greatest = std::max(greatest, expected);
      }
    }
  }
  EXPECT_GT(greatest, 16u);
}

TEST(WordVotes, GivesTheVotesOfSignaturesWhicheverMapIsFirst) {
  std::uint32_t greatest = 0;
  for (const std::uint32_t seed : {10u, 16u, 22u, 28u}) {
    const MergeInput input = make_toy_merge(test::toy_world(seed));
    ASSERT_EQ(input.options.votes, VoteRule::kSignatures);
    const WordVotes votes(*input.appearances, input.members[0], input.members[1]);
    const WordVotes swapped(*input.appearances, input.members[1], input.members[0]);
    std::vector<std::uint32_t> row_votes;
    for (std::uint32_t row = 0; row < votes.rows(); ++row) {
      votes_of_row(votes, row, VoteRule::kSignatures, row_votes);
      for (std::uint32_t column = 0; column < votes.columns(); ++column) {
        const std::uint32_t expected =
            test::votes_by_signatures(*input.appearances->appearances(input.members[1].vertices[row]),
                                      *input.appearances->appearances(input.members[0].vertices[column]));
        EXPECT_EQ(row_votes[column], expected);
        EXPECT_EQ(votes_of_pair(votes, row, column, VoteRule::kSignatures), expected);
        EXPECT_EQ(votes_of_pair(swapped, column, row, VoteRule::kSignatures), expected);
        greatest = std::max(greatest, expected);
      }
    }
  }
  EXPECT_GT(greatest, 8u);
}

TEST(WordVotes, KnowsItsInputAgain) {
  const MergeInput input = make_toy_merge(test::toy_world(19));
  const WordVotes once(*input.appearances, input.members[0], input.members[1]);
  const WordVotes twice(*input.appearances, input.members[0], input.members[1]);
  const WordVotes swapped(*input.appearances, input.members[1], input.members[0]);
  for (const VoteRule rule : {VoteRule::kMin, VoteRule::kSignatures}) {
    EXPECT_EQ(once.fingerprint(rule), twice.fingerprint(rule));
    EXPECT_NE(once.fingerprint(rule), swapped.fingerprint(rule));
  }
}

// A merge that was begun by words goes on whatever the signatures: its fingerprint is what it was before they voted.
TEST(WordVotes, SignaturesAreOfTheInputOnlyWhereTheyVote) {
  const MergeInput input = make_toy_merge(test::toy_world(16));
  std::vector<std::shared_ptr<const AppearanceVector>> others;
  for (const MergeMember& member : input.members) {
    for (const VertexId v : member.vertices) {
      AppearanceVector image = *input.appearances->appearances(v);
      for (Appearance& a : image.appearances) a.signature.bits[0] ^= 0x10101010u;
      others.push_back(std::make_shared<const AppearanceVector>(std::move(image)));
    }
  }
  const WordVotes votes(*input.appearances, input.members[0], input.members[1]);
  const WordVotes changed(AppearanceTable(others), input.members[0], input.members[1]);
  EXPECT_EQ(votes.fingerprint(VoteRule::kMin), changed.fingerprint(VoteRule::kMin));
  EXPECT_EQ(votes.fingerprint(VoteRule::kProduct), changed.fingerprint(VoteRule::kProduct));
  EXPECT_NE(votes.fingerprint(VoteRule::kSignatures), changed.fingerprint(VoteRule::kSignatures));
}

}  // namespace
}  // namespace mapweld
