// What one word adds to the similarity S of an image and others, by each rule.
#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/retrieval/agreement.h"
#include "core/retrieval/postings.h"
#include "core/types.h"

namespace mapweld {

// An image counts a word at most so often.
inline constexpr std::size_t kMostFeaturesOfWord = 65535;

// Votes of single words; keeps scratch, so that one serves many calls, of one thread.
class WordVoter {
 public:
  explicit WordVoter(VoteRule rule) : rule_(rule) {}

  // Calls `add(VertexId, std::uint32_t votes)` for each vertex of `list` to which the word gives votes, ascending.
  // `features`: the signatures of the image's features with the word; `list`: all postings of the word, of other
  // images. Votes of two images are the same from either side.
  template <typename Add>
  void vote(std::span<const VoteSignature> features, const PostingSpan& list, Add&& add) {
    if (rule_ != VoteRule::kSignatures) {
      by_counts(std::min(features.size(), kMostFeaturesOfWord), list.vertices, add);
    } else if (features.size() == 1) {
      by_one_signature(features.front(), list, add);
    } else {
      by_signatures(features, list, add);
    }
  }

 private:
  // So many postings are compared at a time, then as many more as the last vertex has.
  static constexpr std::size_t kAtATime = 4096;

  template <typename Add>
  void by_counts(std::size_t count, std::span<const VertexId> vertices, Add& add) const {
    for (std::size_t from = 0, to = 0; from < vertices.size(); from = to) {
      to = end_of_vertex(vertices, from);
      const std::size_t other = std::min(to - from, kMostFeaturesOfWord);
      add(vertices[from],
          static_cast<std::uint32_t>(rule_ == VoteRule::kProduct ? count * other : std::min(count, other)));
    }
  }

  // One feature: each vertex with a feature that agrees gets one vote.
  template <typename Add>
  void by_one_signature(VoteSignature feature, const PostingSpan& list, Add& add) {
    VertexId last{};
    bool is_first = true;
    for (std::size_t from = 0; from < list.size(); from += kAtATime) {
      const PostingSpan now = list.part(from, std::min(from + kAtATime, list.size()));
      find_agreeing(feature, now.signatures, masks(agreement_words(now.size())));
      for_each_bit(0, agreement_words(now.size()), [&](std::size_t k) {
        if (!is_first && now.vertices[k] == last) return;
        is_first = false;
        last = now.vertices[k];
        add(last, 1u);
      });
    }
  }

  // Several features: the lesser of how many of them agree with one of the vertex's, and how many of the vertex's agree
  // with one of them.
  template <typename Add>
  void by_signatures(std::span<const VoteSignature> features, const PostingSpan& list, Add& add) {
    for (std::size_t from = 0, to = 0; from < list.size(); from = to) {
      to = std::min(from + kAtATime, list.size());
      while (to < list.size() && list.vertices[to] == list.vertices[to - 1]) ++to;
      const PostingSpan now = list.part(from, to);
      // One row of bits a feature, and above them which postings agree with any.
      const std::size_t words = agreement_words(now.size());
      std::uint64_t* const any = masks(words * (features.size() + 1));
      std::fill_n(any, words, 0);
      for (std::size_t f = 0; f < features.size(); ++f) {
        std::uint64_t* const row = any + (f + 1) * words;
        find_agreeing(features[f], now.signatures, row);
        for (std::size_t w = 0; w < words; ++w) any[w] |= row[w];
      }
      std::size_t next = 0;  // postings before it are done with
      for_each_bit(0, words, [&](std::size_t k) {
        if (k < next) return;
        next = end_of_vertex(now.vertices, k);
        std::size_t theirs = 0, ours = 0;
        for (std::size_t j = k; j < next; ++j) theirs += bit(any, j);
        for (std::size_t f = 0; f < features.size() && ours < theirs; ++f) {
          const std::uint64_t* const row = any + (f + 1) * words;
          std::size_t j = k;
          while (j < next && bit(row, j) == 0) ++j;
          ours += j < next ? 1 : 0;
        }
        add(now.vertices[k], static_cast<std::uint32_t>(std::min({ours, theirs, kMostFeaturesOfWord})));
      });
    }
  }

  static std::size_t bit(const std::uint64_t* words, std::size_t k) { return words[k / 64] >> k % 64 & 1; }

  std::uint64_t* masks(std::size_t words) {
    if (masks_.size() < words) masks_.resize(words);
    return masks_.data();
  }

  template <typename Use>
  void for_each_bit(std::size_t first_word, std::size_t end_word, Use&& use) const {
    for (std::size_t w = first_word; w < end_word; ++w) {
      for (std::uint64_t word = masks_[w]; word != 0; word &= word - 1) {
        use(w * 64 + static_cast<std::size_t>(std::countr_zero(word)));
      }
    }
  }

  VoteRule rule_;
  std::vector<std::uint64_t> masks_;
};

}  // namespace mapweld
