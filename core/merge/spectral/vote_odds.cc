#include "core/merge/spectral/vote_odds.h"

#include <cmath>
#include <cstddef>
#include <cstdint>

#include "core/geometry/portable_math.h"

namespace mapweld {
namespace {

using Cell = CandidateEvidence::Cell;

// Fitted to what is confirmed in the end: docs/spectral.md.
constexpr double kConstant = -7.302;
constexpr double kVotes = 1.622;         // of log2
constexpr double kVotesAround = 2.471;   // of log2(1 + the mean over all pairs of images around)
constexpr double kShareAround = -5.886;  // of the square root of the share of those pairs that are candidates
constexpr double kSteps = 1024;

// The rows, or the columns, of each vertex.
class PlacesOfVertices {
 public:
  PlacesOfVertices(std::uint32_t vertices, std::span<const VertexId> vertex_at)
      : begins_(vertices + std::size_t{1}, 0), places_(vertex_at.size()) {
    for (const VertexId v : vertex_at) ++begins_[to_index(v) + std::size_t{1}];
    for (std::size_t v = 0; v < vertices; ++v) begins_[v + 1] += begins_[v];
    auto next = begins_;
    for (std::uint32_t place = 0; place < vertex_at.size(); ++place) {
      places_[next[to_index(vertex_at[place])]++] = place;
    }
  }
  std::span<const std::uint32_t> of(VertexId v) const {
    const std::size_t begin = begins_[to_index(v)];
    return std::span(places_).subspan(begin, begins_[to_index(v) + std::size_t{1}] - begin);
  }

 private:
  std::vector<std::uint32_t> begins_, places_;
};

// A vertex and those that it is linked to.
template <typename Act>
void for_all_around(const AppearanceGraph& graph, VertexId v, const Act& act) {
  act(v);
  for (const Neighbour& n : graph.neighbours(v)) act(n.vertex);
}

double around(const AppearanceGraph& graph, VertexId v) { return 1 + static_cast<double>(graph.neighbours(v).size()); }

struct Sums {
  std::int64_t votes = 0, candidates = 0;
};

float odds_of(std::uint32_t votes, const Sums& sums_around, double pairs_around) {
  const double mean = pairs_around > 0 ? static_cast<double>(sums_around.votes) / pairs_around : 0;
  const double share = pairs_around > 0 ? static_cast<double>(sums_around.candidates) / pairs_around : 0;
  const double odds = kConstant + kVotes * portable_log2(votes) + kVotesAround * portable_log2(1 + mean) +
                      kShareAround * std::sqrt(share);
  return static_cast<float>(std::floor(odds * kSteps) / kSteps);
}

}  // namespace

std::vector<float> vote_odds(const AppearanceGraph& inner, std::span<const VertexId> sources,
                             std::span<const VertexId> targets, std::span<const Cell> cells) {
  const PlacesOfVertices rows(inner.vertices(), sources), columns(inner.vertices(), targets);
  std::vector<std::size_t> begins(sources.size() + 1, 0);  // of each row's cells
  for (const Cell& c : cells) ++begins[c.row + std::size_t{1}];
  for (std::size_t r = 0; r < sources.size(); ++r) begins[r + 1] += begins[r];

  std::vector<float> odds;
  odds.reserve(cells.size());
  std::vector<Sums> sums(targets.size());  // by column, over the rows of all images around the row's
  for (std::uint32_t row = 0; row < sources.size(); ++row) {
    const std::span<const Cell> of_row = cells.subspan(begins[row], begins[row + std::size_t{1}] - begins[row]);
    if (of_row.empty()) continue;
    const VertexId source = sources[row];
    const auto for_cells_around = [&](const auto& act) {
      for_all_around(inner, source, [&](VertexId v) {
        for (const std::uint32_t r : rows.of(v)) {
          for (std::size_t i = begins[r]; i < begins[r + std::size_t{1}]; ++i) act(cells[i]);
        }
      });
    };
    for_cells_around([&](const Cell& c) {
      sums[c.column].votes += c.votes;
      ++sums[c.column].candidates;
    });
    for (const Cell& c : of_row) {
      const VertexId target = targets[c.column];
      Sums of_cell{-static_cast<std::int64_t>(c.votes), -1};  // without itself
      for_all_around(inner, target, [&](VertexId v) {
        for (const std::uint32_t column : columns.of(v)) {
          of_cell.votes += sums[column].votes;
          of_cell.candidates += sums[column].candidates;
        }
      });
      odds.push_back(odds_of(c.votes, of_cell, around(inner, source) * around(inner, target) - 1));
    }
    for_cells_around([&](const Cell& c) { sums[c.column] = {}; });
  }
  return odds;
}

}  // namespace mapweld
