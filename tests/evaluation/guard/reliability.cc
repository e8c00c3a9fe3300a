#include "tests/evaluation/guard/reliability.h"

#include <algorithm>
#include <cstdio>
#include <iterator>

#include "server/evaluation/chart.h"

namespace mapweld::evaluation {

Reliability::Reliability(std::size_t most_a_case) : most_a_case_(most_a_case) {
  const double ends[] = {0, 0.1, 0.3, 0.5, 0.7, 0.9, 0.95, 0.99, 0.999, 1};
  for (std::size_t i = 0; i + 1 < std::size(ends); ++i) {
    ReliabilityBin& bin = bins_.emplace_back();
    bin.from = ends[i];
    bin.to = ends[i + 1];
  }
}

void Reliability::add(const JudgedMerge& judged, const std::vector<GuardVerdict>& verdicts, bool unknown_is_right) {
  std::vector<std::size_t> taken;
  for (std::size_t e = 0; e < verdicts.size(); ++e) {
    if (unknown_is_right || judged.inter_truth[e] != Truth::kUnknown) taken.push_back(e);
  }
  if (taken.empty()) return;
  const double each = std::min(1.0, static_cast<double>(most_a_case_) / static_cast<double>(taken.size()));
  for (const std::size_t e : taken) {
    const double confidence = verdicts[e].confidence;
    const auto bin = std::ranges::find_if(bins_, [&](const ReliabilityBin& b) { return confidence < b.to; });
    ReliabilityBin& into = bin == bins_.end() ? bins_.back() : *bin;
    const bool right = judged.inter_truth[e] != Truth::kWrong;
    ++into.edges;
    into.right += right ? 1 : 0;
    into.weight += each;
    into.weight_right += right ? each : 0;
    into.weight_confidence += each * confidence;
  }
}

std::string reliability_table(const Reliability& reliability) {
  std::string text =
      "| confidence | edges | right | mean confidence % | right %, each case at most 300 |\n|---|---|---|---|---|\n";
  for (const ReliabilityBin& bin : reliability.bins()) {
    char line[160];
    std::snprintf(line, sizeof line, "| %.3g to %.3g | %zu | %zu | %.2f | %.2f |\n", bin.from, bin.to, bin.edges,
                  bin.right, 100 * bin.mean_confidence(), 100 * bin.share_right());
    text += line;
  }
  return text;
}

std::string reliability_svg(const Reliability& reliability, const std::string& subtitle) {
  using namespace server::evaluation;
  ChartSeries measured{.style = {.colour = "#0072B2"}, .dots = true};
  for (const ReliabilityBin& bin : reliability.bins()) {
    if (bin.weight > 0) measured.points.push_back({bin.mean_confidence(), bin.share_right()});
  }
  const ChartStyle ideal{.colour = "#999999", .dashes = "4 3"};
  ChartPanel panel{.x_title = "confidence", .y_title = "share that is right", .x_least = 0};
  panel.series = {
      {.style = ideal, .points = {{0, 0}, {1, 1}}}, {.style = measured.style, .points = measured.points}, measured};
  Chart chart;
  chart.title = "Confidence of verified edges";
  chart.subtitle = subtitle;
  chart.legend = {{"measured", measured.style}, {"as it should be", ideal}};
  chart.panels = {panel};
  return chart_svg(chart);
}

}  // namespace mapweld::evaluation
