// What votes alone tell about each candidate of a merge.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "core/graph/appearance_graph.h"
#include "core/merge/spectral/candidate_evidence.h"

namespace mapweld {

// Log-odds that each candidate will be a confirmed edge, before anything is verified: by its own votes, and by the
// votes around it, between the images that its two images are linked to in their own maps (and the two themselves). Two
// views of one place have neighbours that share views too; two that only look alike seldom have. Weights fitted once
// (docs/spectral.md).
// `inner`: inner edges, over all merged vertices. `sources`, `targets`: the vertex of each row, of each column, which
// may have several (PairBlocks). `cells`: the candidates, ascending by (row, column), each once. Multiples of 1/1024,
// so that sums of them are exact. The same on every processor. Costs some operations a candidate and link of its
// images.
std::vector<float> vote_odds(const AppearanceGraph& inner, std::span<const VertexId> sources,
                             std::span<const VertexId> targets, std::span<const CandidateEvidence::Cell> cells);

// The same bit by bit. What it is made of must outlive it and stay as it is.
class VoteOdds {
 public:
  VoteOdds(const AppearanceGraph& inner, std::span<const VertexId> sources, std::span<const VertexId> targets,
           std::span<const CandidateEvidence::Cell> cells);
  // Works out those of so many more candidates, and of the rest of the last one's row. Whether that was all.
  bool advance(std::size_t candidates);
  std::vector<float> take() { return std::move(odds_); }  // when all are there

 private:
  // The rows, or the columns, of each vertex.
  class Places {
   public:
    Places(std::uint32_t vertices, std::span<const VertexId> vertex_at);
    std::span<const std::uint32_t> of(VertexId v) const {
      const std::size_t begin = begins_[to_index(v)];
      return std::span(places_).subspan(begin, begins_[to_index(v) + std::size_t{1}] - begin);
    }

   private:
    std::vector<std::uint32_t> begins_, places_;
  };
  struct Sums {
    std::int64_t votes = 0, candidates = 0;
  };
  void add_row(std::uint32_t row);

  const AppearanceGraph& inner_;
  std::span<const VertexId> sources_, targets_;
  std::span<const CandidateEvidence::Cell> cells_;
  Places rows_, columns_;
  std::vector<std::size_t> begins_;  // of each row's cells
  std::vector<Sums> sums_;           // by column, over the rows of all images around the row's; zero between rows
  std::vector<float> odds_;
  std::uint32_t next_row_ = 0;
};

}  // namespace mapweld
