#include "tests/evaluation/guard/guard_prefixes.h"

#include <algorithm>
#include <map>
#include <span>
#include <utility>

namespace mapweld::evaluation {
namespace {

constexpr double kLeastShare = 0.7;
constexpr std::size_t kSome = 20;

double share(std::size_t part, std::size_t whole) {
  return whole == 0 ? 1 : static_cast<double>(part) / static_cast<double>(whole);
}

void take(const PrefixCounts& counts, std::size_t& most, PrefixFigures& figures) {
  const double joined = share(counts.joined_rightly, counts.joined_by_verified);
  figures.least_share = std::min(figures.least_share, joined);
  figures.below_70_percent += joined < kLeastShare ? 1 : 0;
  if (counts.joined_by_verified >= kSome) figures.least_share_of_20 = std::min(figures.least_share_of_20, joined);
  most = std::max(most, counts.joined);
  figures.last_of_best = share(counts.joined, most);
  figures.largest_fall = std::max(figures.largest_fall, 1 - figures.last_of_best);
  figures.not_as_fresh += counts.as_fresh ? 0 : 1;
  figures.wrong_confirmed = std::max(figures.wrong_confirmed, counts.wrong_confirmed);
}

}  // namespace

PrefixFigures guard_prefixes(const JudgedMerge& judged, const std::vector<MergeEdge>& edges, std::size_t parts,
                             const GuardOptions& options, bool compare) {
  std::map<std::pair<VertexId, VertexId>, std::size_t> number_of;
  for (std::size_t e = 0; e < judged.merge.inter_edges.size(); ++e) {
    number_of[{judged.merge.inter_edges[e].u, judged.merge.inter_edges[e].v}] = e;
  }
  const auto members = judged.merge.members();
  const auto appearances = judged.merge.appearances();
  AliasGuard guard(members, judged.inner, appearances, options);
  PrefixFigures figures;
  std::size_t most = 0, before = 0;
  for (std::size_t part = 1; part <= parts; ++part) {
    const std::size_t size = (edges.size() * part + parts - 1) / parts;
    if (size == before) continue;
    before = size;
    const std::span<const MergeEdge> prefix(edges.data(), size);
    const auto& verdicts = guard.verdicts(prefix);
    PrefixCounts counts;
    counts.edges = size;
    std::vector<std::size_t> confirmed, rightly, not_wrong;
    for (std::size_t i = 0; i < size; ++i) {
      const std::size_t e = number_of.at({edges[i].u, edges[i].v});
      const bool is_wrong = judged.inter_truth[e] == Truth::kWrong;
      if (!is_wrong) not_wrong.push_back(e);
      if (!verdicts[i].confirmed()) continue;
      confirmed.push_back(e);
      if (!is_wrong) rightly.push_back(e);
      counts.wrong_confirmed += is_wrong ? 1 : 0;
    }
    counts.confirmed = confirmed.size();
    counts.joined = joined_by(judged, confirmed).both();
    counts.joined_rightly = joined_by(judged, rightly).both();
    counts.joined_by_verified = joined_by(judged, not_wrong).both();
    if (compare) counts.as_fresh = verdicts == guard_edges(members, judged.inner, prefix, appearances, options);
    take(counts, most, figures);
    figures.prefixes.push_back(counts);
  }
  return figures;
}

}  // namespace mapweld::evaluation
