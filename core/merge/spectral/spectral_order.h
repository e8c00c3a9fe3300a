// Which candidates of a merge to verify next: chance to pass times gain in algebraic connectivity.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/graph/appearance_graph.h"
#include "core/graph/disjoint_sets.h"
#include "core/merge/spectral/candidate_evidence.h"
#include "core/merge/spectral/certificate_order.h"
#include "core/merge/spectral/connectivity_gain.h"
#include "core/merge/spectral/shortlist.h"

namespace mapweld {

// All numbers are measured on the maps of docs/spectral.md.
struct SpectralOptions {
  // Verdicts are waited for in batches: so many candidates, or this part (1/n) of the verifications made when that is
  // more.
  std::uint32_t least_batch = 8;
  std::uint32_t batch_part = 16;
  // The graph is embedded anew, and all candidates are looked through, at the first batch after so many verifications,
  // or one verification for so many vertices, or this part of those made, whichever is most; and when the largest
  // component has grown by this part.
  std::uint32_t least_epoch = 32;
  std::uint32_t epoch_vertices = 16;
  std::uint32_t epoch_part = 4;
  std::uint32_t growth_part = 20;
  // Candidates that are looked at again for each batch of an epoch, for each one that the epoch will verify.
  std::uint32_t shortlist = 4;
  // Every so many-th verification is given to QuickConnect's order.
  std::uint32_t quickconnect_share = 4;
  // Six of eight verifications go to what keeps the certificate low (certificate_order.h).
  bool serves_certificate = false;
  // What joining two components is worth, the best strengthening edge being worth 1: join_weight, and join_size times
  // the square root of the smaller one's share of all vertices.
  double join_weight = 2;
  double join_size = 4;
  ConnectivityGain::Options gain;
  // Making the order: the odds of so many candidates, about, are one step's work.
  std::uint32_t odds_at_once = 1 << 18;
};

// When batches and epochs begin. A function of the number of verifications and of the components.
class SpectralSchedule {
 public:
  SpectralSchedule(const AppearanceGraph& graph, const SpectralOptions& options);
  void join(VertexId u, VertexId v);
  // Asked at the beginning of each batch: whether an epoch begins with it.
  bool begins_epoch(std::uint64_t verifications);
  std::uint64_t next_epoch() const { return next_epoch_; }  // verifications, unless the component grows before
  std::uint64_t batch_size(std::uint64_t verifications) const;

 private:
  SpectralOptions options_;
  DisjointSets sets_;
  std::uint32_t vertices_;
  std::uint32_t largest_;
  std::uint64_t next_epoch_ = 0;
  std::uint32_t largest_then_ = 0;
};

// Batch by batch: next_batch(), then note() for each of its candidates, and so on until all have a verdict. What comes
// next is a function of the input and of the verdicts in order of their batches; restore() goes on from them.
//
// An epoch begins with the lowest eigenvectors of the graph as it is (ConnectivityGain). Each candidate is scored with
// its chance to pass, squared, times its gain when both ends are in the largest component; when it would join two
// components, with its chance squared times what that is worth (join_weight, join_size; gains are scaled so that the
// best of them is worth its chance squared). The best ones are the epoch's short list. For each batch the chances are
// learnt anew, edges that arrived are taken in, and candidates are picked greedily, each pick being expected to pass
// with its chance when the others are scored again.
//
// Beside that every `quickconnect_share`-th verification goes to the order that QuickConnect would take: the candidate
// with the most votes of each source that has no inter edge yet, by votes; then other candidates of such sources, by
// votes; then those of joined sources by (lower degree of the two ends, votes descending); ties by number. That order
// is drawn up when an epoch begins; candidates whose source has been joined since are passed over while there are
// others. So of its first n verifications at least n / quickconnect_share (rounded down) are QuickConnect's.
//
// Where the certificate is served, four of eight go to the candidates within the largest component that keep it low,
// and two to those that could still join it, as drawn up when the epoch begins; when none of those is left, to the
// short list.
class SpectralOrder {
 public:
  struct Verdict {
    std::uint32_t candidate = 0;
    bool passed = false;
  };
  // `graph`: all members, the edges that there are when verifications begin. `sources`, `targets`: the vertex of each
  // row, of each column; a vertex may have several (PairBlocks). `cells`: the candidates, ascending by (row, column),
  // each once; they are numbered in this order. `odds`: of each candidate, by votes alone (vote_odds).
  SpectralOrder(AppearanceGraph graph, std::span<const VertexId> sources, std::span<const VertexId> targets,
                std::vector<CandidateEvidence::Cell> cells, std::vector<float> odds, const SpectralOptions& options);

  std::uint32_t size() const { return evidence_.size(); }
  // The candidate of a row and a column; size() when there is none.
  std::uint32_t find(std::uint32_t row, std::uint32_t column) const { return evidence_.find(row, column); }
  const CandidateEvidence::Cell& cell(std::uint32_t candidate) const { return evidence_.cell(candidate); }
  bool has_verdict(std::uint32_t candidate) const { return !evidence_.is_open(candidate); }

  // The candidates to verify next, in this order; empty when all have a verdict. Costs an embedding when an epoch
  // begins. Requires a verdict for each of the former batch.
  std::vector<std::uint32_t> next_batch();
  void note(Verdict verdict);
  // What the batch after this one may hold; a guess, and nothing after restore().
  const std::vector<std::uint32_t>& expected() const { return expected_; }

  // On a fresh order: as after the batch that began with verification number `batch_began` (counted from 0) was chosen,
  // and these verdicts noted. Costs one embedding. Throws FormatError when no batch begins there.
  void restore(std::span<const Verdict> verdicts, std::uint64_t batch_began);

 private:
  VertexId source(std::uint32_t candidate) const { return sources_[cell(candidate).row]; }
  VertexId target(std::uint32_t candidate) const { return targets_[cell(candidate).column]; }
  bool is_strengthening(std::uint32_t candidate) const {
    return gain_->is_embedded(source(candidate)) && gain_->is_embedded(target(candidate));
  }
  double join_worth(std::uint32_t component_a, std::uint32_t component_b) const;
  void begin_batch(bool may_embed);
  void begin_epoch();
  struct QuickConnectCursors {
    std::size_t next = 0, next_passed_over = 0;
  };
  void draw_certificate(const PassModel& model, std::size_t count);
  std::uint32_t next_of_quickconnect(QuickConnectCursors& cursors) const;

  SpectralOptions options_;
  AppearanceGraph graph_;
  std::span<const VertexId> sources_, targets_;
  CandidateEvidence evidence_;
  SpectralSchedule schedule_;
  std::uint64_t verifications_ = 0;
  std::vector<std::uint8_t> is_joined_;  // by vertex: it has an inter edge
  std::vector<std::uint32_t> passed_;    // not yet taken into schedule and gain, in order
  std::vector<bool> is_picked_;          // by candidate: for the batch that is being chosen
  std::vector<std::uint32_t> expected_;
  JoinWorth join_worth_;
  // Of the epoch:
  std::optional<ConnectivityGain> gain_;
  std::vector<std::uint32_t> shortlist_;  // ascending
  struct QuickConnectPick {
    std::uint32_t candidate = 0;
    bool was_joined = false;  // its source
  };
  std::vector<QuickConnectPick> quickconnect_;
  CertificateOrder certificate_;  // by candidates' numbers
};

}  // namespace mapweld
