#include "tests/evaluation/guard/guard_tables.h"

#include <algorithm>
#include <cstdio>
#include <random>
#include <utility>
#include <vector>

namespace mapweld::evaluation {
namespace {

std::string percent(std::size_t part, std::size_t whole) {
  if (whole == 0) return "-";
  char text[16];
  std::snprintf(text, sizeof text, "%.1f", 100.0 * static_cast<double>(part) / static_cast<double>(whole));
  return text;
}

std::string three(const EdgeCounts& c) {
  return std::to_string(c.right) + " / " + std::to_string(c.wrong) + " / " + std::to_string(c.unknown);
}

std::string two(const Joined& joined) { return std::to_string(joined.a) + " + " + std::to_string(joined.b); }

}  // namespace

void print_counts_head() {
  std::printf(
      "| case | candidates | verified r / w / ? | confirmed r / w / ? | of r and ? %% | joined by verified | joined | "
      "%% | wrong joins verified, confirmed | inner verified r / w / ? | inner confirmed r / w / ? | places | verified "
      "| "
      "confirmed | ms |\n|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|\n");
}

void print_counts(const std::string& title, const GuardCounts& c) {
  std::printf("| %s | %llu | %s | %s | %s | %s | %s | %s | %zu, %zu | %s | %s | %zu | %zu | %zu | %.0f + %.0f |\n",
              title.c_str(), static_cast<unsigned long long>(c.candidates), three(c.verified).c_str(),
              three(c.confirmed).c_str(), percent(c.confirmed.not_wrong(), c.verified.not_wrong()).c_str(),
              two(c.joined_by_verified).c_str(), two(c.joined).c_str(),
              percent(c.joined.both(), c.joined_by_verified.both()).c_str(), c.wrong_joins_verified, c.wrong_joins,
              three(c.inner_verified).c_str(), three(c.inner_confirmed).c_str(), c.places, c.places_verified,
              c.places_confirmed, c.members_ms, c.edges_ms);
  std::fflush(stdout);
}

void print_prefixes_head() {
  std::printf(
      "| case | prefixes | edges | least joined of right verified %% | prefixes below 70 %% | least, of 20 images or "
      "more %% "
      "| largest fall %% | last of best %% | unlike a fresh guard | most wrong confirmed |\n"
      "|---|---|---|---|---|---|---|---|---|---|\n");
}

void print_prefixes(const std::string& title, const PrefixFigures& f) {
  std::printf("| %s | %zu | %zu | %.1f | %zu | %.1f | %.1f | %.1f | %zu | %zu |\n", title.c_str(), f.prefixes.size(),
              f.prefixes.empty() ? 0 : f.prefixes.back().edges, 100 * f.least_share, f.below_70_percent,
              100 * f.least_share_of_20, 100 * f.largest_fall, 100 * f.last_of_best, f.not_as_fresh, f.wrong_confirmed);
  std::fflush(stdout);
}

void print_wrong_confirmed(const JudgedMerge& judged, const GuardRun& run) {
  for (std::size_t e = 0; e < run.inter.size(); ++e) {
    if (!run.inter[e].confirmed() || judged.inter_truth[e] != Truth::kWrong) continue;
    const MergeEdge& edge = judged.merge.inter_edges[e];
    std::printf("  wrong: %s - %s, %d inliers, confidence %.4f:", judged.shown[to_index(edge.u)].c_str(),
                judged.shown[to_index(edge.v)].c_str(), edge.verification.inliers, run.inter[e].confidence);
    for (const EvidenceItem& item : evidence_items(run.inter[e].evidence)) {
      std::printf(" %s %.3g", item.name.c_str(), item.value);
      if (item.log_odds) std::printf(" (%+.2f)", *item.log_odds);
    }
    std::printf("\n");
  }
}

void print_sample(const JudgedMerge& judged, const GuardRun& run, std::size_t most, std::uint64_t seed) {
  std::vector<std::size_t> confirmed;
  for (std::size_t e = 0; e < run.inter.size(); ++e) {
    if (run.inter[e].confirmed()) confirmed.push_back(e);
  }
  std::mt19937_64 random(seed);
  for (std::size_t i = 0; i < std::min(most, confirmed.size()); ++i) {
    std::swap(confirmed[i], confirmed[i + random() % (confirmed.size() - i)]);
    const MergeEdge& edge = judged.merge.inter_edges[confirmed[i]];
    std::printf("%s,%s,%.4f,%d\n", judged.shown[to_index(edge.u)].c_str(), judged.shown[to_index(edge.v)].c_str(),
                run.inter[confirmed[i]].confidence, edge.verification.inliers);
  }
}

}  // namespace mapweld::evaluation
