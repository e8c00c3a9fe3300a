#include "core/merge/similarity_matrix.h"

#include <map>
#include <random>

#include <gtest/gtest.h>

#include "core/errors.h"

namespace mapweld {
namespace {

// What a word gives: to some rows, each some columns.
using WordVotesOfRows = std::vector<std::pair<std::uint32_t, std::vector<VotedVertex>>>;

WordVotesOfRows random_word(std::mt19937& random, std::uint32_t rows, std::uint32_t columns) {
  WordVotesOfRows word;
  for (std::uint32_t row = 0; row < rows; ++row) {
    if (random() % 3 != 0) continue;
    word.emplace_back(row, std::vector<VotedVertex>{});
    for (std::uint32_t column = 0; column < columns; ++column) {
      if (random() % 3 == 0)
        word.back().second.push_back({VertexId{column}, 1 + static_cast<std::uint32_t>(random() % 4)});
    }
  }
  return word;
}

// A map of pairs is the oracle; sparse cells are those that reach min_votes in the end.
TEST(SimilarityMatrix, CountsVotesInEitherLayout) {
  for (std::uint32_t seed = 0; seed < 20; ++seed) {
    std::mt19937 random(seed);
    const std::uint32_t rows = 7, columns = 11, min_votes = 12;
    std::vector<WordVotesOfRows> words;
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> final_votes;
    for (int w = 0; w < 40; ++w) {
      words.push_back(random_word(random, rows, columns));
      for (const auto& [row, given] : words.back()) {
        for (const VotedVertex& c : given) final_votes[{row, to_index(c.vertex)}] += c.votes;
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
    for (const WordVotesOfRows& word : words) {
      std::vector<SimilarityMatrix::Cell> expected, of_dense, of_sparse;
      for (const auto& [row, given] : word) {
        for (const VotedVertex& c : given) {
          std::uint32_t& cell = votes[{row, to_index(c.vertex)}];
          const std::uint32_t before = cell;
          cell += c.votes;
          if (before < min_votes && cell >= min_votes) expected.push_back({row, to_index(c.vertex), cell});
        }
        dense.add(row, given, min_votes, of_dense);
        sparse.add(row, given, min_votes, of_sparse);
      }
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
  matrix.add(0, std::vector<VotedVertex>{{VertexId{0}, 60000}}, 65535, reached);
  EXPECT_EQ(matrix.at(0, 0), 60000u);
  matrix.add(0, std::vector<VotedVertex>{{VertexId{0}, 3600000000}}, 65535, reached);
  EXPECT_EQ(matrix.at(0, 0), 65535u);
  EXPECT_EQ(reached.size(), 1u);
}

TEST(SimilarityMatrix, IsRestoredFromItsParts) {
  SimilarityMatrix sparse = SimilarityMatrix::sparse(3, 9);
  sparse.append_row(std::vector<std::uint32_t>{1, 4});
  sparse.append_row({});
  std::vector<SimilarityMatrix::Cell> reached;
  sparse.add(0, std::vector<VotedVertex>{{VertexId{4}, 6}}, 1, reached);
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
