// Where the candidates of a pair of maps come from: words that both maps have, and who has them (paper, getVotes).
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/merge/merge_input.h"
#include "core/retrieval/postings.h"
#include "core/types.h"

namespace mapweld {

// m2's vertices are the rows of S, m1's its columns; a posting's vertex is a row or a column, that is the member's own
// vertex number. Immutable: any number of threads may read.
class VoteSource {
 public:
  virtual ~VoteSource() = default;

  virtual std::uint32_t rows() const = 0;     // |V2|
  virtual std::uint32_t columns() const = 0;  // |V1|

  // The words that appear in m2 and in m1, ascending. Everything below names a word by its index here.
  virtual std::span<const WordId> words() const = 0;
  // The features with the word in m2 (in m1), ascending by image.
  virtual PostingSpan row_postings(std::uint32_t word) const = 0;
  virtual PostingSpan column_postings(std::uint32_t word) const = 0;

  struct RowWord {
    std::uint32_t word = 0;
    std::uint32_t count = 0;  // features with it
  };
  // The words of an image of m2 (the paper's getWords), ascending; and the signatures of its features with them, one
  // word's after the other's.
  virtual std::span<const RowWord> row_words(std::uint32_t row) const = 0;
  virtual std::span<const VoteSignature> row_signatures(std::uint32_t row) const = 0;

  // A hash of everything above that votes by `rule` depend on, by which a checkpoint knows its own input again.
  virtual std::uint64_t fingerprint(VoteRule rule) const = 0;
};

// The visual words of two members.
class WordVotes final : public VoteSource {
 public:
  // Reads every appearance vector once. Postings of words that only one of the two maps has are not kept.
  WordVotes(const AppearanceSource& appearances, const MergeMember& m1, const MergeMember& m2);

  std::uint32_t rows() const override { return rows_; }
  std::uint32_t columns() const override { return columns_; }
  std::span<const WordId> words() const override { return words_; }
  PostingSpan row_postings(std::uint32_t word) const override;
  PostingSpan column_postings(std::uint32_t word) const override;
  std::span<const RowWord> row_words(std::uint32_t row) const override;
  std::span<const VoteSignature> row_signatures(std::uint32_t row) const override;
  std::uint64_t fingerprint(VoteRule rule) const override;

 private:
  std::uint32_t rows_ = 0;
  std::uint32_t columns_ = 0;
  std::vector<WordId> words_;
  // Compressed sparse rows: the postings of word w are [offsets[w], offsets[w + 1]).
  std::vector<std::uint64_t> row_offsets_, column_offsets_, row_word_offsets_, row_signature_offsets_;
  PostingList row_postings_, column_postings_;
  std::vector<RowWord> row_words_;
  std::vector<VoteSignature> row_signatures_;  // as row_postings_, but by row
};

// The final votes of one pair.
std::uint32_t votes_of_pair(const VoteSource& source, std::uint32_t row, std::uint32_t column, VoteRule rule);

// The final votes of a row against every column: `votes` is resized to columns(). Cost: the postings of the row's
// words.
void votes_of_row(const VoteSource& source, std::uint32_t row, VoteRule rule, std::vector<std::uint32_t>& votes);

// How many pairs have final votes of `min_votes` or more: all the candidates that a merge will ever verify. Cost: all
// votes once.
std::uint64_t count_candidates(const VoteSource& source, VoteRule rule, std::uint32_t min_votes);

}  // namespace mapweld
