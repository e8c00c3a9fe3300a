#include "core/merge/spectral/spectral_order.h"

#include <algorithm>
#include <unordered_map>
#include <utility>

#include "core/errors.h"
#include "core/graph/components.h"
#include "core/merge/spectral/largest_first.h"
#include "core/merge/spectral/quickconnect_draw.h"

namespace mapweld {
namespace {

struct Scored {
  double score = 0;
  std::uint32_t candidate = 0;
  // Of two the one that is taken later: a heap keeps the greatest on top.
  bool operator<(const Scored& o) const { return score != o.score ? score < o.score : candidate > o.candidate; }
};

double squared(double x) { return x * x; }

constexpr std::size_t kLeastExpected = 64;  // as many as can be verified while an epoch begins

}  // namespace

SpectralSchedule::SpectralSchedule(const AppearanceGraph& graph, const SpectralOptions& options)
    : options_(options), sets_(graph.vertices()), vertices_(graph.vertices()), largest_(graph.vertices() == 0 ? 0 : 1) {
  for (std::uint32_t v = 0; v < vertices_; ++v) {
    for (const Neighbour& n : graph.neighbours(VertexId{v})) join(VertexId{v}, n.vertex);
  }
}

void SpectralSchedule::join(VertexId u, VertexId v) {
  if (sets_.join(to_index(u), to_index(v))) largest_ = std::max(largest_, sets_.size_of(to_index(u)));
}

bool SpectralSchedule::begins_epoch(std::uint64_t verifications) {
  const bool has_grown = largest_ > largest_then_ + largest_then_ / options_.growth_part;
  if (verifications < next_epoch_ && !has_grown) return false;
  next_epoch_ = verifications + std::max<std::uint64_t>({options_.least_epoch, vertices_ / options_.epoch_vertices,
                                                         verifications / options_.epoch_part});
  largest_then_ = largest_;
  return true;
}

std::uint64_t SpectralSchedule::batch_size(std::uint64_t verifications) const {
  return std::max<std::uint64_t>(options_.least_batch, verifications / options_.batch_part);
}

SpectralOrder::SpectralOrder(AppearanceGraph graph, std::span<const VertexId> sources,
                             std::span<const VertexId> targets, std::vector<CandidateEvidence::Cell> cells,
                             std::vector<float> odds, const SpectralOptions& options)
    : options_(options),
      graph_(std::move(graph)),
      sources_(sources),
      targets_(targets),
      evidence_(static_cast<std::uint32_t>(sources.size()), static_cast<std::uint32_t>(targets.size()),
                std::move(cells), std::move(odds)),
      schedule_(graph_, options),
      is_joined_(graph_.vertices(), 0),
      is_picked_(evidence_.size(), false),
      join_worth_{options.join_weight, options.join_size, graph_.vertices()} {}

void SpectralOrder::note(Verdict verdict) {
  evidence_.note(verdict.candidate, verdict.passed);
  ++verifications_;
  if (!verdict.passed) return;
  graph_.add_edge(source(verdict.candidate), target(verdict.candidate), 1);
  is_joined_[to_index(source(verdict.candidate))] = is_joined_[to_index(target(verdict.candidate))] = 1;
  passed_.push_back(verdict.candidate);
}

void SpectralOrder::begin_batch(bool may_embed) {
  for (const std::uint32_t c : passed_) schedule_.join(source(c), target(c));
  if (schedule_.begins_epoch(verifications_)) {
    if (may_embed) begin_epoch();
  } else if (gain_) {
    for (const std::uint32_t c : passed_) gain_->add(source(c), target(c));
  }
  passed_.clear();
}

void SpectralOrder::begin_epoch() {
  const Components components = connected_components(graph_);
  const std::uint32_t largest = graph_.vertices() == 0 ? 0 : components.largest();
  const auto strengthens = [&](std::uint32_t c) {
    return components.component_of[to_index(source(c))] == largest &&
           components.component_of[to_index(target(c))] == largest;
  };
  std::uint32_t first = 0;
  while (first < size() && (has_verdict(first) || !strengthens(first))) ++first;
  gain_.emplace(graph_, options_.gain, first < size());
  const std::uint64_t end = schedule_.next_epoch();
  const std::uint64_t picks = end - verifications_ + schedule_.batch_size(end);  // the most that the epoch can take
  const PassModel model(evidence_.counts());
  shortlist_ = draw_shortlist({evidence_, model, *gain_, sources_, targets_, join_worth_},
                              std::min<std::uint64_t>(evidence_.open(), options_.shortlist * picks));
  quickconnect_.clear();
  for (const std::uint32_t c : draw_quickconnect(evidence_, graph_, is_joined_, sources_, targets_,
                                                 std::min<std::uint64_t>(evidence_.open(), picks))) {
    quickconnect_.push_back({c, is_joined_[to_index(source(c))] != 0});
  }
  draw_certificate(model, std::min<std::uint64_t>(evidence_.open(), picks));
}

double SpectralOrder::join_worth(std::uint32_t component_a, std::uint32_t component_b) const {
  return join_worth_.of(std::min(gain_->component_size(component_a), gain_->component_size(component_b)));
}

// The joining ones in the order of their chance.
void SpectralOrder::draw_certificate(const PassModel& model, std::size_t count) {
  certificate_ = {};
  if (!options_.serves_certificate) return;
  std::vector<Scored> by_chance;
  by_chance.reserve(evidence_.open());
  for (std::uint32_t c = 0; c < size(); ++c) {
    if (!has_verdict(c)) by_chance.push_back({model.chance(evidence_.features(c)), c});
  }
  std::ranges::sort(by_chance, [](const Scored& a, const Scored& b) { return b < a; });
  std::vector<std::pair<VertexId, VertexId>> open;
  open.reserve(by_chance.size());
  for (const Scored& s : by_chance) open.emplace_back(source(s.candidate), target(s.candidate));
  certificate_ = certificate_order(graph_, open, count);
  for (std::vector<std::uint32_t>* list : {&certificate_.within, &certificate_.joining}) {
    for (std::uint32_t& i : *list) i = by_chance[i].candidate;
  }
}

std::vector<std::uint32_t> SpectralOrder::next_batch() {
  begin_batch(true);
  const std::size_t size =
      std::min<std::uint64_t>(evidence_.size() - verifications_, schedule_.batch_size(verifications_));
  std::erase_if(shortlist_, [this](std::uint32_t c) { return has_verdict(c); });
  std::erase_if(quickconnect_, [this](const QuickConnectPick& p) { return has_verdict(p.candidate); });

  // Strengthening candidates come with their gain; the others with the pair of components that they would join.
  const PassModel model(evidence_.counts());
  struct Entry {
    double chance = 0;
    double worth = 0;  // of joining, per chance
    bool strengthens = false;
    std::uint64_t joint = 0;  // 0: none
  };
  std::vector<Entry> entries(shortlist_.size());
  double best = 0, best_chance = 0;
  std::vector<Scored> scored;
  scored.reserve(shortlist_.size());
  for (std::uint32_t i = 0; i < shortlist_.size(); ++i) {
    const std::uint32_t c = shortlist_[i];
    Entry& entry = entries[i];
    entry.chance = squared(model.chance(evidence_.features(c)));
    entry.strengthens = is_strengthening(c);
    if (entry.strengthens) {
      const double score = entry.chance * gain_->gain(source(c), target(c));
      scored.push_back({score, i});
      if (score > best) {
        best = score;
        best_chance = entry.chance;
      }
      continue;
    }
    const std::uint32_t a = gain_->component(source(c)), b = gain_->component(target(c));
    if (a != b) {
      entry.joint = std::uint64_t{std::min(a, b)} << 32 | std::max(a, b);
      entry.worth = join_worth(a, b);
    }
    scored.push_back({0, i});
  }
  const double scale = best > 0 ? best_chance / best : 0;
  std::unordered_map<std::uint64_t, double> unjoined;  // chance that no pick so far joins these two components
  const auto score_of = [&](std::uint32_t i) {
    const Entry& entry = entries[i];
    if (entry.strengthens) return scale * entry.chance * gain_->gain(source(shortlist_[i]), target(shortlist_[i]));
    if (entry.joint == 0) return kWorthElsewhere * entry.chance;
    const auto known = unjoined.find(entry.joint);
    return entry.worth * entry.chance * (known == unjoined.end() ? 1.0 : known->second);
  };
  for (Scored& s : scored) s.score = entries[s.candidate].strengthens ? scale * s.score : score_of(s.candidate);
  LargestFirst<Scored> queue(std::move(scored), size);

  std::vector<std::uint32_t> batch;
  QuickConnectCursors cursors;
  const auto pick = [&](std::uint32_t c) {
    is_picked_[c] = true;
    batch.push_back(c);
  };
  std::size_t next_within = 0, next_joining = 0;
  const auto pick_first_of = [&](const std::vector<std::uint32_t>& list, std::size_t& next) {
    while (next < list.size() && (is_picked_[list[next]] || has_verdict(list[next]))) ++next;
    if (next == list.size()) return false;
    pick(list[next++]);
    return true;
  };
  const ConnectivityGain::Metric metric = gain_->metric();
  while (batch.size() < size) {
    const std::uint64_t number = verifications_ + batch.size(), turn = number % 8;
    if (turn % 2 == 0 && pick_first_of(certificate_.within, next_within)) continue;
    if ((turn == 1 || turn == 5) && pick_first_of(certificate_.joining, next_joining)) continue;
    if ((number + 1) % options_.quickconnect_share == 0) {
      pick(next_of_quickconnect(cursors));
      continue;
    }
    while (true) {
      Scored top = queue.pop();
      const std::uint32_t c = shortlist_[top.candidate];
      if (is_picked_[c]) continue;  // for QuickConnect's order
      top.score = score_of(top.candidate);
      if (!queue.empty() && top < queue.front()) {
        queue.push(top);
        continue;
      }
      pick(c);
      const Entry& entry = entries[top.candidate];
      if (entry.strengthens) {
        gain_->expect(source(c), target(c), entry.chance);
      } else if (entry.joint != 0) {
        unjoined.try_emplace(entry.joint, 1.0).first->second *= 1 - entry.chance;
      }
      break;
    }
  }
  gain_->set_metric(metric);
  // The runners-up, as if no verdict changed anything.
  expected_.clear();
  const auto expect_next_of = [&](const std::vector<std::uint32_t>& list, std::size_t& next) {
    if (next < list.size()) expected_.push_back(list[next++]);
  };
  while (expected_.size() < std::max(size, kLeastExpected) && !queue.empty()) {
    for (std::uint32_t i = 1; i < std::max(options_.quickconnect_share, 2U) && !queue.empty(); ++i) {
      expected_.push_back(shortlist_[queue.pop().candidate]);
    }
    if (cursors.next < quickconnect_.size()) expected_.push_back(quickconnect_[cursors.next++].candidate);
    expect_next_of(certificate_.within, next_within);
    expect_next_of(certificate_.joining, next_joining);
  }
  std::erase_if(expected_, [this](std::uint32_t c) { return is_picked_[c] || has_verdict(c); });
  for (const std::uint32_t c : batch) is_picked_[c] = false;
  return batch;
}

// The next candidate of QuickConnect's order that is not picked yet. Both cursors only go forward within a batch.
std::uint32_t SpectralOrder::next_of_quickconnect(QuickConnectCursors& cursors) const {
  const auto is_free = [this](const QuickConnectPick& pick) { return !is_picked_[pick.candidate]; };
  for (; cursors.next < quickconnect_.size(); ++cursors.next) {
    const QuickConnectPick& pick = quickconnect_[cursors.next];
    const bool is_passed_over = !pick.was_joined && is_joined_[to_index(source(pick.candidate))] != 0;
    if (is_free(pick) && !is_passed_over) return pick.candidate;
  }
  while (!is_free(quickconnect_[cursors.next_passed_over])) ++cursors.next_passed_over;
  return quickconnect_[cursors.next_passed_over].candidate;
}

void SpectralOrder::restore(std::span<const Verdict> verdicts, std::uint64_t batch_began) {
  SpectralSchedule plan = schedule_;
  std::uint64_t epoch_began = 0;
  for (std::uint64_t at = 0, taken = 0;;) {
    for (; taken < std::min<std::uint64_t>(at, verdicts.size()); ++taken) {
      const auto [c, has_passed] = verdicts[taken];
      if (has_passed) plan.join(source(c), target(c));
    }
    if (plan.begins_epoch(at)) epoch_began = at;
    if (at == batch_began) break;
    at += plan.batch_size(at);
    if (at > batch_began) throw FormatError("a merge state whose batch begins where none does");
  }
  std::uint64_t next = 0;
  for (std::uint64_t i = 0; i <= verdicts.size(); ++i) {
    if (i == next && i <= batch_began) {
      begin_batch(i == epoch_began);
      next += schedule_.batch_size(i);
    }
    if (i < verdicts.size()) note(verdicts[i]);
  }
}

}  // namespace mapweld
