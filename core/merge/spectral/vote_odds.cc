#include "core/merge/spectral/vote_odds.h"

#include <algorithm>
#include <cmath>

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

// A vertex and those that it is linked to.
template <typename Act>
void for_all_around(const AppearanceGraph& graph, VertexId v, const Act& act) {
  act(v);
  for (const Neighbour& n : graph.neighbours(v)) act(n.vertex);
}

double around(const AppearanceGraph& graph, VertexId v) { return 1 + static_cast<double>(graph.neighbours(v).size()); }

float odds_of(std::uint32_t votes, std::int64_t votes_around, std::int64_t candidates_around, double pairs_around) {
  const double mean = pairs_around > 0 ? static_cast<double>(votes_around) / pairs_around : 0;
  const double share = pairs_around > 0 ? static_cast<double>(candidates_around) / pairs_around : 0;
  const double odds = kConstant + kVotes * portable_log2(votes) + kVotesAround * portable_log2(1 + mean) +
                      kShareAround * std::sqrt(share);
  return static_cast<float>(std::floor(odds * kSteps) / kSteps);
}

}  // namespace

VoteOdds::Places::Places(std::uint32_t vertices, std::span<const VertexId> vertex_at)
    : begins_(vertices + std::size_t{1}, 0), places_(vertex_at.size()) {
  for (const VertexId v : vertex_at) ++begins_[to_index(v) + std::size_t{1}];
  for (std::size_t v = 0; v < vertices; ++v) begins_[v + 1] += begins_[v];
  auto next = begins_;
  for (std::uint32_t place = 0; place < vertex_at.size(); ++place) {
    places_[next[to_index(vertex_at[place])]++] = place;
  }
}

VoteOdds::VoteOdds(const AppearanceGraph& inner, std::span<const VertexId> sources, std::span<const VertexId> targets,
                   std::span<const Cell> cells)
    : inner_(inner),
      sources_(sources),
      targets_(targets),
      cells_(cells),
      rows_(inner.vertices(), sources),
      columns_(inner.vertices(), targets),
      begins_(sources.size() + 1, 0),
      sums_(targets.size()) {
  for (const Cell& c : cells) ++begins_[c.row + std::size_t{1}];
  for (std::size_t r = 0; r < sources.size(); ++r) begins_[r + 1] += begins_[r];
  odds_.reserve(cells.size());
}

bool VoteOdds::advance(std::size_t candidates) {
  const std::size_t until = odds_.size() + std::min(candidates, cells_.size() - odds_.size());
  for (; odds_.size() < until; ++next_row_) add_row(next_row_);
  return odds_.size() == cells_.size();
}

void VoteOdds::add_row(std::uint32_t row) {
  const std::span<const Cell> of_row = cells_.subspan(begins_[row], begins_[row + std::size_t{1}] - begins_[row]);
  if (of_row.empty()) return;
  const VertexId source = sources_[row];
  const auto for_cells_around = [&](const auto& act) {
    for_all_around(inner_, source, [&](VertexId v) {
      for (const std::uint32_t r : rows_.of(v)) {
        for (std::size_t i = begins_[r]; i < begins_[r + std::size_t{1}]; ++i) act(cells_[i]);
      }
    });
  };
  for_cells_around([&](const Cell& c) {
    sums_[c.column].votes += c.votes;
    ++sums_[c.column].candidates;
  });
  for (const Cell& c : of_row) {
    const VertexId target = targets_[c.column];
    Sums of_cell{-static_cast<std::int64_t>(c.votes), -1};  // without itself
    for_all_around(inner_, target, [&](VertexId v) {
      for (const std::uint32_t column : columns_.of(v)) {
        of_cell.votes += sums_[column].votes;
        of_cell.candidates += sums_[column].candidates;
      }
    });
    const double pairs_around = around(inner_, source) * around(inner_, target) - 1;
    odds_.push_back(odds_of(c.votes, of_cell.votes, of_cell.candidates, pairs_around));
  }
  for_cells_around([&](const Cell& c) { sums_[c.column] = {}; });
}

std::vector<float> vote_odds(const AppearanceGraph& inner, std::span<const VertexId> sources,
                             std::span<const VertexId> targets, std::span<const CandidateEvidence::Cell> cells) {
  VoteOdds odds(inner, sources, targets, cells);
  odds.advance(cells.size());
  return odds.take();
}

}  // namespace mapweld
