#include "core/retrieval/voting.h"

#include <algorithm>
#include <span>

#include "core/retrieval/word_voter.h"

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

// The image's words one after the other, each with the signatures of its features.
class ImageWords {
 public:
  explicit ImageWords(const AppearanceVector& image) : appearances_(image.appearances) { next(); }
  bool done() const { return from_ == appearances_.size(); }
  WordId word() const { return appearances_[from_].word; }
  std::span<const VoteSignature> features() const { return features_; }
  void next() {
    from_ = to_;
    features_.clear();
    for (; to_ < appearances_.size() && appearances_[to_].word == appearances_[from_].word; ++to_) {
      features_.push_back(vote_signature(appearances_[to_].signature));
    }
  }

 private:
  std::span<const Appearance> appearances_;
  std::size_t from_ = 0, to_ = 0;
  std::vector<VoteSignature> features_;
};

}  // namespace

Votes vote(const AppearanceVector& query, const PostingSource& map, VoteRule rule, std::uint32_t min_votes) {
  Votes result;
  const std::uint32_t vertices = map.vertices();
  std::vector<std::uint32_t>& counters = zeroed_counters(vertices);
  WordVoter voter(rule);
  ImageWords words(query);
  bool is_known = false;
  const PostingSource::Visitor count = [&](const PostingSource::Piece& piece) {
    is_known = true;
    voter.vote(words.features(), piece.postings,
               [of_map = counters.data(), shift = piece.shift](VertexId vertex, std::uint32_t votes) {
                 of_map[to_index(vertex) + shift] += votes;
               });
  };
  try {
    for (; !words.done(); words.next()) {
      is_known = false;
      map.visit(words.word(), count);
      result.known_words += is_known ? 1 : 0;
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
  std::uint32_t votes = 0;
  WordVoter voter(rule);
  std::vector<VertexId> vertices;  // all the same: b is the only other image
  ImageWords of_a(a), of_b(b);
  while (!of_a.done() && !of_b.done()) {
    if (of_a.word() < of_b.word()) {
      of_a.next();
    } else if (of_b.word() < of_a.word()) {
      of_b.next();
    } else {
      vertices.resize(of_b.features().size());
      voter.vote(of_a.features(), {vertices, of_b.features()},
                 [&votes](VertexId, std::uint32_t given) { votes += given; });
      of_a.next();
      of_b.next();
    }
  }
  return votes;
}

}  // namespace mapweld
