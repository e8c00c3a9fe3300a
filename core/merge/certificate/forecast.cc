#include "core/merge/certificate/forecast.h"

#include <algorithm>
#include <array>
#include <utility>

#include "core/merge/certificate/hop_search.h"
#include "core/merge/logistic.h"
#include "core/merge/spectral/pass_model.h"
#include "core/merge/spectral/vote_odds.h"

namespace mapweld {
namespace {

constexpr double kOffsetVariance = 20;  // of a class's offset, before verdicts: wide

// Log-odds by class: fitted on the real places and on rendered seeds 301 to 310 (docs/certificate.md).
struct Weights {
  double constant, votes, rivals, passes, done, smaller_component_log2;
};
constexpr std::array<Weights, kNearnesses> kCandidates{{
    {0.627, 1.441, -1.463, 0.406, -1.649, 0},
    {-0.950, 1.823, -1.121, 0.414, -2.918, 0},
    {-1.620, 1.933, -0.876, 0.530, -2.197, 0},
    {-2.140, 2.078, -0.586, 0.690, -1.805, 0},
    {-2.979, 1.740, -0.837, 0.247, -1.943, -0.198},
}};
// Of verified edges that are not confirmed.
struct WithheldWeights {
  std::array<double, kNearnesses> by_class;
  double confidence, done, left;
};
constexpr WithheldWeights kWithheld{{-0.042, 0.018, 0.734, -0.578, 0.026}, 0.425, -1.831, 1.519};

// The offset of a class's log-odds that its verdicts are likeliest with.
double offset_of(const std::vector<std::pair<double, bool>>& verdicts) {
  double offset = 0;
  for (int step = 0; step < 30; ++step) {
    double slope = -offset / kOffsetVariance, curvature = 1 / kOffsetVariance;
    for (const auto& [odds, is_confirmed] : verdicts) {
      const double p = logistic(odds + offset);
      slope += (is_confirmed ? 1 : 0) - p;
      curvature += p * (1 - p);
    }
    const double change = std::clamp(slope / curvature, -1.0, 1.0);
    offset += change;
    if (change < 1e-4 && change > -1e-4) break;
  }
  return offset;
}

// Stretches of the members' own maps: an image and those that are linked to it by inner edges within two hops, each in
// the first stretch that reaches it.
std::vector<std::uint32_t> stretches_of(const AppearanceGraph& inner) {
  constexpr std::uint32_t kNone = 0xFFFFFFFF;
  std::vector<std::uint32_t> stretch(inner.vertices(), kNone);
  for (std::uint32_t v = 0; v < inner.vertices(); ++v) {
    if (stretch[v] != kNone) continue;
    stretch[v] = v;
    std::vector<VertexId> reached{VertexId{v}};
    for (int hop = 0; hop < 2; ++hop) {
      std::vector<VertexId> next;
      for (const VertexId u : reached) {
        for (const Neighbour& n : inner.neighbours(u)) {
          if (stretch[to_index(n.vertex)] != kNone) continue;
          stretch[to_index(n.vertex)] = v;
          next.push_back(n.vertex);
        }
      }
      reached = std::move(next);
    }
  }
  return stretch;
}

}  // namespace

void Forecast::begin(const Merger& merger, const std::vector<Candidate>& open) {
  const MergeState& state = merger.state();
  position_.resize(state.vertices);
  for (const MergeMember& member : merger.input().members) {
    for (const VertexId v : member.vertices) {
      position_[to_index(v)] = static_cast<std::uint32_t>(vertex_at_.size());
      vertex_at_.push_back(v);
    }
    vertex_at_.resize(vertex_at_.size() + CandidateEvidence::kWindow);
  }
  std::vector<CandidateEvidence::Cell> cells;
  const auto add = [&](VertexId u, VertexId v, std::uint32_t votes) {
    const auto [row, column] = std::minmax(position_[to_index(u)], position_[to_index(v)]);
    cells.push_back({row, column, votes});
  };
  for (const Candidate& c : open) add(c.source, c.target, c.votes);
  for (const MergeEdge& e : state.edges) add(e.u, e.v, e.votes);
  for (const RejectedPair& r : state.rejected) add(r.source, r.target, r.votes);
  std::ranges::sort(cells, {}, [](const CandidateEvidence::Cell& c) { return std::pair(c.row, c.column); });
  std::vector<std::uint32_t> most(vertex_at_.size(), 1);
  for (const CandidateEvidence::Cell& c : cells) {
    most[c.row] = std::max(most[c.row], c.votes);
    most[c.column] = std::max(most[c.column], c.votes);
  }
  for (const CandidateEvidence::Cell& c : cells) {
    rivals_.push_back(static_cast<double>(c.votes) / most[c.row] + static_cast<double>(c.votes) / most[c.column]);
  }
  const auto positions = static_cast<std::uint32_t>(vertex_at_.size());
  const AppearanceGraph inner(state.vertices, merger.input().inner_edges);
  std::vector<float> odds = vote_odds(inner, vertex_at_, vertex_at_, cells);
  evidence_.emplace(positions, positions, std::move(cells), std::move(odds));
  stretch_ = stretches_of(inner);
}

std::uint32_t Forecast::number_of(VertexId u, VertexId v) const {
  const auto [row, column] = std::minmax(position_[to_index(u)], position_[to_index(v)]);
  return evidence_->find(row, column);
}

void Forecast::note_verdicts(const MergeState& state) {
  for (; edges_noted_ < state.edges.size(); ++edges_noted_) {
    evidence_->note(number_of(state.edges[edges_noted_].u, state.edges[edges_noted_].v), true);
  }
  for (; rejected_noted_ < state.rejected.size(); ++rejected_noted_) {
    evidence_->note(number_of(state.rejected[rejected_noted_].source, state.rejected[rejected_noted_].target), false);
  }
}

std::optional<std::vector<OpenCandidate>> Forecast::open(const Merger& merger, const AppearanceGraph& confirmed_graph,
                                                         std::span<const EdgeStanding> standings) {
  if (merger.done()) return std::vector<OpenCandidate>{};
  if (!evidence_) {
    const auto open = merger.open_candidates();
    if (!open) return std::nullopt;
    begin(merger, *open);
  }
  const MergeState& state = merger.state();
  note_verdicts(state);
  const std::uint32_t count = evidence_->size();
  std::vector<std::uint8_t> is_confirmed(count, 0);
  for (std::size_t e = 0; e < state.edges.size(); ++e) {
    if (standings.empty() || standings[e].confirmed) is_confirmed[number_of(state.edges[e].u, state.edges[e].v)] = 1;
  }

  const double done = count == 0 ? 1 : static_cast<double>(state.verifications) / count;
  const PassModel model(evidence_->counts());
  HopSearch hops(confirmed_graph);
  struct Open {
    std::uint32_t candidate;
    Nearness nearness;
    double odds;
  };
  std::vector<Open> open;
  std::array<std::vector<std::pair<double, bool>>, kNearnesses> verdicts;
  // A search from each row serves all its candidates but the edges, which have to be left out one by one.
  std::vector<std::uint32_t> confirmed;
  const auto take = [&](std::uint32_t c, const Relation& relation) {
    const CandidateEvidence::Cell& cell = evidence_->cell(c);
    const Weights& w = kCandidates[relation.nearness];
    double odds = w.constant +
                  w.votes * portable_log2(static_cast<double>(cell.votes) / merger.input().options.min_votes) +
                  w.rivals * rivals_[c] + w.passes * log_odds(model.chance(evidence_->features(c))) + w.done * done +
                  w.smaller_component_log2 * relation.smaller_component_log2;
    if (evidence_->verdict(c) == CandidateEvidence::Verdict::kNone) {
      open.push_back({c, relation.nearness, odds});
    } else {
      verdicts[relation.nearness].emplace_back(odds, is_confirmed[c] != 0);
    }
  };
  std::optional<std::uint32_t> row;
  for (std::uint32_t c = 0; c < count; ++c) {
    if (is_confirmed[c] != 0) {
      confirmed.push_back(c);
      continue;
    }
    const CandidateEvidence::Cell& cell = evidence_->cell(c);
    if (row != cell.row) hops.begin(vertex_at_[cell.row]);
    row = cell.row;
    take(c, hops.to(vertex_at_[cell.column]));
  }
  for (const std::uint32_t c : confirmed) {
    const CandidateEvidence::Cell& cell = evidence_->cell(c);
    take(c, hops.without_edge(vertex_at_[cell.row], vertex_at_[cell.column]));
  }

  std::array<double, kNearnesses> offsets{};
  for (std::size_t k = 0; k < kNearnesses; ++k) offsets[k] = offset_of(verdicts[k]);
  const auto forecast = [&](VertexId u, VertexId v, bool comes_with_its_place, double chance) {
    const auto [a, b] = std::minmax(u, v);
    OpenCandidate told{a, b, chance};
    if (comes_with_its_place) {
      const auto [s, t] = std::minmax(stretch_[to_index(a)], stretch_[to_index(b)]);
      told.place = {VertexId{s}, VertexId{t}};
    }
    return told;
  };
  std::vector<OpenCandidate> result;
  for (const Open& o : open) {
    const CandidateEvidence::Cell& cell = evidence_->cell(o.candidate);
    result.push_back(forecast(vertex_at_[cell.row], vertex_at_[cell.column], o.nearness >= kFourHops,
                              logistic(o.odds + offsets[o.nearness])));
  }
  if (standings.empty()) return result;
  const double left = portable_log2(1 - done + 1e-3);
  for (std::size_t e = 0; e < state.edges.size(); ++e) {
    if (standings[e].confirmed) continue;
    const Nearness nearness = hops.without_edge(state.edges[e].u, state.edges[e].v).nearness;
    const double odds = kWithheld.by_class[nearness] + kWithheld.confidence * log_odds(standings[e].confidence) +
                        kWithheld.done * done + kWithheld.left * left;
    result.push_back(forecast(state.edges[e].u, state.edges[e].v, true, logistic(odds)));
  }
  return result;
}

}  // namespace mapweld
