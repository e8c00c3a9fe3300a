#include "core/merge/vote_source.h"

#include <algorithm>
#include <memory>

#include "core/fingerprint.h"
#include "core/retrieval/word_voter.h"

namespace mapweld {
namespace {

// A feature of an image.
struct Occurrence {
  std::uint32_t word;
  std::uint32_t vertex;  // the member's own
  VoteSignature signature;
};

// Every feature of every image, ordered by image and then word.
std::vector<Occurrence> occurrences_of(const AppearanceSource& appearances, const MergeMember& member) {
  std::vector<Occurrence> result;
  for (std::uint32_t v = 0; v < member.vertices.size(); ++v) {
    const std::shared_ptr<const AppearanceVector> image = appearances.appearances(member.vertices[v]);
    for (const Appearance& a : image->appearances) {
      result.push_back({to_index(a.word), v, vote_signature(a.signature)});
    }
  }
  return result;
}

std::vector<std::uint32_t> distinct_words(const std::vector<Occurrence>& occurrences) {
  std::vector<std::uint32_t> words;
  words.reserve(occurrences.size());
  for (const Occurrence& o : occurrences) words.push_back(o.word);
  std::ranges::sort(words);
  words.erase(std::ranges::unique(words).begin(), words.end());
  return words;
}

// Puts the occurrences of known words into postings by word. `word_number` gives a word's index, or kUnknown.
constexpr std::uint32_t kUnknown = 0xFFFFFFFF;
void fill_postings(const std::vector<Occurrence>& occurrences, const std::vector<std::uint32_t>& word_number,
                   std::size_t words, std::vector<std::uint64_t>& offsets, PostingList& postings) {
  offsets.assign(words + 1, 0);
  for (const Occurrence& o : occurrences) {
    if (word_number[o.word] != kUnknown) ++offsets[word_number[o.word] + 1];
  }
  for (std::size_t w = 0; w < words; ++w) offsets[w + 1] += offsets[w];
  postings.resize(offsets.back());
  std::vector<std::uint64_t> next(offsets.begin(), offsets.end() - 1);
  for (const Occurrence& o : occurrences) {
    const std::uint32_t word = word_number[o.word];
    if (word == kUnknown) continue;
    const std::uint64_t at = next[word]++;
    postings.vertices[at] = VertexId{o.vertex};
    postings.signatures[at] = o.signature;
  }
}

PostingSpan slice(const PostingList& all, const std::vector<std::uint64_t>& offsets, std::uint32_t word) {
  return PostingSpan(all).part(offsets[word], offsets[word + 1]);
}

template <typename T>
std::span<const T> row_of(const std::vector<T>& all, const std::vector<std::uint64_t>& offsets, std::uint32_t row) {
  return std::span(all).subspan(offsets[row], offsets[row + 1] - offsets[row]);
}

// Calls use(word, signatures of the row's features with it) for each word of a row.
template <typename Use>
void for_each_word(const VoteSource& source, std::uint32_t row, Use&& use) {
  std::span<const VoteSignature> left = source.row_signatures(row);
  for (const VoteSource::RowWord& w : source.row_words(row)) {
    use(w.word, left.first(w.count));
    left = left.subspan(w.count);
  }
}

}  // namespace

WordVotes::WordVotes(const AppearanceSource& appearances, const MergeMember& m1, const MergeMember& m2)
    : rows_(static_cast<std::uint32_t>(m2.vertices.size())), columns_(static_cast<std::uint32_t>(m1.vertices.size())) {
  const std::vector<Occurrence> of_rows = occurrences_of(appearances, m2);
  const std::vector<Occurrence> of_columns = occurrences_of(appearances, m1);
  const std::vector<std::uint32_t> row_words = distinct_words(of_rows), column_words = distinct_words(of_columns);
  std::uint32_t highest = 0;
  if (!row_words.empty()) highest = std::max(highest, row_words.back());
  if (!column_words.empty()) highest = std::max(highest, column_words.back());
  std::vector<std::uint32_t> word_number(static_cast<std::size_t>(highest) + 1, kUnknown);
  for (const std::uint32_t word : row_words) {
    if (!std::ranges::binary_search(column_words, word)) continue;
    word_number[word] = static_cast<std::uint32_t>(words_.size());
    words_.push_back(WordId{word});
  }
  fill_postings(of_rows, word_number, words_.size(), row_offsets_, row_postings_);
  fill_postings(of_columns, word_number, words_.size(), column_offsets_, column_postings_);

  row_word_offsets_.assign(1, 0);
  row_signature_offsets_.assign(1, 0);
  std::size_t next = 0;
  for (std::uint32_t row = 0; row < rows_; ++row) {
    for (; next < of_rows.size() && of_rows[next].vertex == row; ++next) {
      const std::uint32_t word = word_number[of_rows[next].word];
      if (word == kUnknown) continue;
      const bool is_new = row_words_.size() == row_word_offsets_.back() || row_words_.back().word != word;
      if (is_new) row_words_.push_back({word, 0});
      ++row_words_.back().count;
      row_signatures_.push_back(of_rows[next].signature);
    }
    row_signature_offsets_.push_back(row_signatures_.size());
    row_word_offsets_.push_back(row_words_.size());
  }
}

std::uint64_t WordVotes::fingerprint(VoteRule rule) const {
  Fingerprint hash;
  hash.add(rows_);
  hash.add(columns_);
  for (std::uint32_t w = 0; w < words_.size(); ++w) {
    hash.add(to_index(words_[w]));
    for (const PostingSpan& postings : {row_postings(w), column_postings(w)}) {
      const std::span<const VertexId> vertices = postings.vertices;
      hash.add(count_vertices(vertices));
      for (std::size_t from = 0, to = 0; from < vertices.size(); from = to) {
        to = end_of_vertex(vertices, from);
        const std::uint64_t count = std::min(to - from, kMostFeaturesOfWord);
        hash.add((static_cast<std::uint64_t>(to_index(vertices[from])) << 16) | count);
      }
      if (rule != VoteRule::kSignatures) continue;
      for (const VoteSignature signature : postings.signatures) hash.add(signature);
    }
  }
  return hash.value();
}

PostingSpan WordVotes::row_postings(std::uint32_t word) const { return slice(row_postings_, row_offsets_, word); }

PostingSpan WordVotes::column_postings(std::uint32_t word) const {
  return slice(column_postings_, column_offsets_, word);
}

std::span<const VoteSource::RowWord> WordVotes::row_words(std::uint32_t row) const {
  return row_of(row_words_, row_word_offsets_, row);
}

std::span<const VoteSignature> WordVotes::row_signatures(std::uint32_t row) const {
  return row_of(row_signatures_, row_signature_offsets_, row);
}

std::uint32_t votes_of_pair(const VoteSource& source, std::uint32_t row, std::uint32_t column, VoteRule rule) {
  std::uint32_t votes = 0;
  WordVoter voter(rule);
  for_each_word(source, row, [&](std::uint32_t word, std::span<const VoteSignature> features) {
    const PostingSpan postings = source.column_postings(word);
    const auto found = std::ranges::lower_bound(postings.vertices, VertexId{column});
    if (found == postings.vertices.end() || *found != VertexId{column}) return;
    const auto from = static_cast<std::size_t>(found - postings.vertices.begin());
    voter.vote(features, postings.part(from, end_of_vertex(postings.vertices, from)),
               [&votes](VertexId, std::uint32_t given) { votes += given; });
  });
  return votes;
}

void votes_of_row(const VoteSource& source, std::uint32_t row, VoteRule rule, std::vector<std::uint32_t>& votes) {
  votes.assign(source.columns(), 0);
  WordVoter voter(rule);
  for_each_word(source, row, [&](std::uint32_t word, std::span<const VoteSignature> features) {
    voter.vote(features, source.column_postings(word),
               [&votes](VertexId column, std::uint32_t given) { votes[to_index(column)] += given; });
  });
}

std::uint64_t count_candidates(const VoteSource& source, VoteRule rule, std::uint32_t min_votes) {
  std::uint64_t candidates = 0;
  std::vector<std::uint32_t> votes;
  for (std::uint32_t row = 0; row < source.rows(); ++row) {
    votes_of_row(source, row, rule, votes);
    candidates += static_cast<std::uint64_t>(
        std::ranges::count_if(votes, [min_votes](std::uint32_t v) { return v >= min_votes; }));
  }
  return candidates;
}

}  // namespace mapweld
