#include "server/evaluation/truth_metrics.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace mapweld::server::evaluation {
namespace {

PrecisionRecall point_of(double threshold, std::uint64_t accepted, std::uint64_t right, std::uint64_t right_pairs) {
  const auto share = [](std::uint64_t part, std::uint64_t whole) {
    return whole == 0 ? 0.0 : static_cast<double>(part) / static_cast<double>(whole);
  };
  return {threshold, accepted, right, share(right, accepted), share(right, right_pairs)};
}

constexpr int kLeastInliers = 8, kMostInliers = 64;
constexpr int kMildest = 0, kStrictest = -40;  // log10 of max_false_alarms

}  // namespace

std::vector<PrecisionRecall> precision_recall(std::vector<ScoredPair> pairs, std::uint64_t right_pairs) {
  std::ranges::sort(pairs, [](const ScoredPair& a, const ScoredPair& b) { return a.score > b.score; });
  std::vector<PrecisionRecall> points;
  std::uint64_t right = 0;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    right += pairs[i].right ? 1 : 0;
    if (i + 1 < pairs.size() && pairs[i + 1].score == pairs[i].score) continue;
    points.push_back(point_of(pairs[i].score, i + 1, right, right_pairs));
  }
  return points;
}

std::optional<PrecisionRecall> at_full_precision(std::span<const PrecisionRecall> points) {
  std::optional<PrecisionRecall> best;
  for (const PrecisionRecall& point : points) {
    if (point.right == point.accepted) best = point;
  }
  return best;
}

std::optional<SuggestedThresholds> suggest_thresholds(std::span<const CandidateVerdict> verdicts, const Truth& truth,
                                                      double min_precision) {
  // counts[f][i]: plausible candidates with at least i inliers, and false alarms of at most 10^-f. First by cell (the
  // strictest that accepts), then summed from the strict end.
  constexpr int kRows = kMildest - kStrictest + 1, kColumns = kMostInliers + 1;
  struct Count {
    std::uint64_t accepted = 0, right = 0;
  };
  std::vector<std::array<Count, kColumns>> counts(kRows);
  for (const CandidateVerdict& v : verdicts) {
    if (!v.plausible || v.inliers < kLeastInliers || v.log10_false_alarms > kMildest) continue;
    const int row = std::min(kRows - 1, static_cast<int>(std::floor(-v.log10_false_alarms)));
    Count& count = counts[static_cast<std::size_t>(row)][static_cast<std::size_t>(std::min(v.inliers, kMostInliers))];
    ++count.accepted;
    count.right += truth.is_right(v.a, v.b) ? 1 : 0;
  }
  std::optional<SuggestedThresholds> best;
  std::array<Count, kColumns> beyond{};
  for (int row = kRows - 1; row >= 0; --row) {
    Count sum;
    for (int i = kMostInliers; i >= kLeastInliers; --i) {
      const auto column = static_cast<std::size_t>(i);
      const Count& here = counts[static_cast<std::size_t>(row)][column];
      beyond[column].accepted += here.accepted;
      beyond[column].right += here.right;
      sum.accepted += beyond[column].accepted;
      sum.right += beyond[column].right;
      if (sum.accepted == 0) continue;
      const PrecisionRecall result = point_of(0, sum.accepted, sum.right, truth.right_pairs());
      if (result.precision < min_precision || (best && result.right < best->result.right)) continue;
      best = SuggestedThresholds{i, -row, result};
    }
  }
  return best;
}

std::vector<RecallAtK> recall_at_k(std::span<const CandidateVerdict> verdicts, const Truth& truth,
                                   std::uint32_t second_vertices, const VerifierOptions& thresholds,
                                   std::span<const std::uint32_t> ks) {
  std::vector<std::vector<const CandidateVerdict*>> of_query(second_vertices);
  for (const CandidateVerdict& v : verdicts) of_query.at(v.b).push_back(&v);
  const std::vector<bool> placed = truth.placed_in_second(second_vertices);
  std::vector<std::uint64_t> found_by_votes(ks.size()), found_verified(ks.size());
  const auto note = [&](const std::vector<const CandidateVerdict*>& ranked, std::vector<std::uint64_t>& found) {
    const auto first = std::ranges::find_if(ranked, [&](const auto* v) { return truth.is_right(v->a, v->b); });
    for (std::size_t i = 0; i < ks.size(); ++i) {
      if (first != ranked.end() && first - ranked.begin() < static_cast<std::ptrdiff_t>(ks[i])) ++found[i];
    }
  };
  for (std::uint32_t query = 0; query < second_vertices; ++query) {
    if (!placed[query]) continue;
    std::vector<const CandidateVerdict*>& ranked = of_query[query];
    std::ranges::sort(
        ranked, [](const auto* x, const auto* y) { return x->votes != y->votes ? x->votes > y->votes : x->a < y->a; });
    note(ranked, found_by_votes);
    std::erase_if(ranked, [&](const auto* v) { return !accepts(*v, thresholds); });
    std::ranges::stable_sort(ranked, [](const auto* x, const auto* y) { return x->inliers > y->inliers; });
    note(ranked, found_verified);
  }
  const auto queries = static_cast<double>(std::max<std::ptrdiff_t>(1, std::ranges::count(placed, true)));
  std::vector<RecallAtK> result;
  for (std::size_t i = 0; i < ks.size(); ++i) {
    result.push_back(
        {ks[i], static_cast<double>(found_by_votes[i]) / queries, static_cast<double>(found_verified[i]) / queries});
  }
  return result;
}

MapPair pair_of(const RecordedEdge& edge, std::uint32_t first_vertices) {
  return {to_index(edge.u), to_index(edge.v) - first_vertices};
}

std::vector<std::uint64_t> wrong_edges(std::span<const RecordedEdge> edges, const Truth& truth,
                                       std::uint32_t first_vertices, Error error) {
  std::vector<std::uint64_t> wrong{0};
  for (const RecordedEdge& edge : edges) {
    const MapPair pair = pair_of(edge, first_vertices);
    const bool is_fine = error == Error::kNotRight ? truth.is_right(pair.a, pair.b) : truth.is_listed(pair.a, pair.b);
    wrong.push_back(wrong.back() + (is_fine ? 0 : 1));
  }
  return wrong;
}

TruthResult judge(std::vector<CandidateVerdict> verdicts, Truth truth, const MergeInput& input,
                  const Evaluation& evaluation, const VerifierOptions& thresholds) {
  const std::vector<VertexId>& second = input.members.at(1).vertices;
  const auto second_vertices = static_cast<std::uint32_t>(second.size());
  TruthResult result;
  result.thresholds = thresholds;
  result.candidates = verdicts.size();
  std::vector<ScoredPair> by_inliers, by_false_alarms;
  std::vector<bool> joined(second_vertices, false);
  std::uint64_t accepted = 0, right_accepted = 0;
  for (const CandidateVerdict& v : verdicts) {
    const bool right = truth.is_right(v.a, v.b);
    result.right_candidates += right ? 1 : 0;
    if (v.plausible) {
      by_inliers.push_back({static_cast<double>(v.inliers), right});
      by_false_alarms.push_back({-v.log10_false_alarms, right});
    }
    if (!accepts(v, thresholds)) continue;
    ++accepted;
    right_accepted += right ? 1 : 0;
    result.unlisted += truth.is_listed(v.a, v.b) ? 0 : 1;
    if (right) joined.at(v.b) = true;
  }
  result.chosen = point_of(0, accepted, right_accepted, truth.right_pairs());
  result.by_inliers = precision_recall(std::move(by_inliers), truth.right_pairs());
  result.by_false_alarms = precision_recall(std::move(by_false_alarms), truth.right_pairs());
  result.without_error = suggest_thresholds(verdicts, truth, 1.0);
  result.nearly = suggest_thresholds(verdicts, truth, 0.999);
  constexpr std::array<std::uint32_t, 7> kRanks{1, 2, 3, 5, 10, 20, 50};
  result.localization = recall_at_k(verdicts, truth, second_vertices, thresholds, kRanks);
  result.placed = static_cast<std::uint32_t>(std::ranges::count(truth.placed_in_second(second_vertices), true));
  result.rightly_joined = static_cast<std::uint32_t>(std::ranges::count(joined, true));
  const std::vector<bool> shares_enough = truth.placed_in_second(second_vertices, kJoinableShare);
  for (std::uint32_t v = 0; v < second_vertices; ++v) {
    if (!shares_enough[v] || input.appearances->appearances(second[v])->appearances.size() < kJoinableFeatures)
      continue;
    ++result.joinable;
    result.joinable_joined += joined[v] ? 1 : 0;
  }
  const std::vector<RecordedEdge> counted = evaluation.counted_edges();
  std::vector<RecordedEdge> right_edges;
  for (const RecordedEdge& edge : counted) {
    const MapPair pair = pair_of(edge, evaluation.member_vertices.front());
    if (truth.is_right(pair.a, pair.b)) right_edges.push_back(edge);
  }
  if (evaluation.final_connectivity > 0) {
    result.right_connectivity =
        FinalComponent(input, counted).connectivity(right_edges) / evaluation.final_connectivity;
  }
  result.truth = std::move(truth);
  return result;
}

}  // namespace mapweld::server::evaluation
