#include "core/merge/similarity_matrix.h"

#include <map>
#include <random>

#include <gtest/gtest.h>

#include "core/errors.h"

namespace mapweld {
namespace {

std::vector<Posting> random_postings(std::mt19937& random, std::uint32_t vertices) {
  std::vector<Posting> postings;
  for (std::uint32_t v = 0; v < vertices; ++v) {
    if (random() % 3 == 0) postings.push_back({VertexId{v}, static_cast<std::uint16_t>(1 + random() % 4)});
  }
  return postings;
}

// A map of pairs is the oracle; sparse cells are those that reach min_votes in the end.
TEST(SimilarityMatrix, CountsVotesInEitherLayout) {
  for (std::uint32_t seed = 0; seed < 20; ++seed) {
    std::mt19937 random(seed);
    const std::uint32_t rows = 7, columns = 11, min_votes = 12;
    const VoteRule rule = seed % 2 == 0 ? VoteRule::kMin : VoteRule::kProduct;
    std::vector<std::pair<std::vector<Posting>, std::vector<Posting>>> words;
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> final_votes;
    for (int w = 0; w < 40; ++w) {
      words.emplace_back(random_postings(random, rows), random_postings(random, columns));
      for (const Posting& r : words.back().first) {
        for (const Posting& c : words.back().second) {
          final_votes[{to_index(r.vertex), to_index(c.vertex)}] +=
              rule == VoteRule::kMin ? std::min(r.count, c.count) : r.count * c.count;
        }
      }
    }
    SimilarityMatrix dense = SimilarityMatrix::dense(rows, columns);
    SimilarityMatrix sparse = SimilarityMatrix::sparse(rows, columns);
    for (std::uint32_t row = 0; row < rows; ++row) {
      std::vector<std::uint32_t> kept;
      for (std::uint32_t column = 0; column < columns; ++column) {
        if (final_votes[{row, column}] >= min_votes) kept.push_back(column);
      }
      sparse.append_row(kept);
    }
    std::size_t all_reached = 0;
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> votes;
    for (const auto& [row_postings, column_postings] : words) {
      std::vector<SimilarityMatrix::Cell> expected, of_dense, of_sparse;
      for (const Posting& r : row_postings) {
        for (const Posting& c : column_postings) {
          std::uint32_t& cell = votes[{to_index(r.vertex), to_index(c.vertex)}];
          const std::uint32_t before = cell;
          cell += rule == VoteRule::kMin ? std::min(r.count, c.count) : r.count * c.count;
          if (before < min_votes && cell >= min_votes)
            expected.push_back({to_index(r.vertex), to_index(c.vertex), cell});
        }
      }
      dense.add(row_postings, column_postings, rule, min_votes, of_dense);
      sparse.add(row_postings, column_postings, rule, min_votes, of_sparse);
      EXPECT_EQ(of_dense, expected);
      EXPECT_EQ(of_sparse, expected);
      all_reached += expected.size();
    }
    EXPECT_GT(all_reached, 0u);
    for (std::uint32_t row = 0; row < rows; ++row) {
      for (std::uint32_t column = 0; column < columns; ++column) {
        const std::uint32_t expected = final_votes[{row, column}];
        EXPECT_EQ(dense.at(row, column), expected);
        EXPECT_EQ(sparse.at(row, column), expected >= min_votes ? expected : 0);
      }
    }
  }
}

TEST(SimilarityMatrix, SaturatesInsteadOfTurningOver) {
  SimilarityMatrix matrix = SimilarityMatrix::dense(1, 1);
  std::vector<SimilarityMatrix::Cell> reached;
  const std::vector<Posting> many{{VertexId{0}, 60000}};
  matrix.add(many, many, VoteRule::kMin, 65535, reached);
  EXPECT_EQ(matrix.at(0, 0), 60000u);
  matrix.add(many, many, VoteRule::kProduct, 65535, reached);
  EXPECT_EQ(matrix.at(0, 0), 65535u);
  EXPECT_EQ(reached.size(), 1u);
}

TEST(SimilarityMatrix, IsRestoredFromItsParts) {
  SimilarityMatrix sparse = SimilarityMatrix::sparse(3, 9);
  sparse.append_row(std::vector<std::uint32_t>{1, 4});
  sparse.append_row({});
  std::vector<SimilarityMatrix::Cell> reached;
  sparse.add(std::vector<Posting>{{VertexId{0}, 2}}, std::vector<Posting>{{VertexId{4}, 3}}, VoteRule::kProduct, 1,
             reached);
  const auto copy = [](const SimilarityMatrix& m) {
    return SimilarityMatrix::restore(m.is_sparse(), m.rows(), m.columns(), {m.offsets().begin(), m.offsets().end()},
                                     {m.kept_columns().begin(), m.kept_columns().end()},
                                     {m.votes().begin(), m.votes().end()});
  };
  EXPECT_EQ(copy(sparse), sparse);
  const SimilarityMatrix dense = SimilarityMatrix::dense(2, 3);
  EXPECT_EQ(copy(dense), dense);
  EXPECT_FALSE(dense == SimilarityMatrix::dense(3, 2));
}

TEST(SimilarityMatrix, RefusesPartsThatDoNotFit) {
  const auto restore = [](bool is_sparse, std::vector<std::uint64_t> offsets, std::vector<std::uint32_t> columns,
                          std::vector<std::uint16_t> votes) {
    return SimilarityMatrix::restore(is_sparse, 2, 5, std::move(offsets), std::move(columns), std::move(votes));
  };
  EXPECT_NO_THROW(restore(true, {0, 1, 2}, {4, 0}, {1, 1}));
  EXPECT_THROW(restore(true, {0, 1, 2}, {5, 0}, {1, 1}), FormatError);
  EXPECT_THROW(restore(true, {0, 2}, {3, 3}, {1, 1}), FormatError);
  EXPECT_THROW(restore(true, {0, 1, 1, 2}, {1, 2}, {1, 1}), FormatError);
  EXPECT_THROW(restore(true, {0, 3}, {1, 2}, {1, 1}), FormatError);
  EXPECT_THROW(restore(true, {}, {}, {}), FormatError);
  EXPECT_THROW(restore(false, {}, {}, {1, 2, 3}), FormatError);
}

}  // namespace
}  // namespace mapweld
