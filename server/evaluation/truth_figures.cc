#include <algorithm>
#include <cmath>
#include <utility>

#include "client/drawing/svg.h"
#include "server/evaluation/figures.h"
#include "server/evaluation/method_series.h"

namespace mapweld::server::evaluation {
namespace {

std::string number(double value) { return drawing::shown(value, 9); }

// By method, by run: how many of the first 0, 1, 2, ... edges are wrong.
using WrongCounts = std::vector<std::vector<std::uint64_t>>;

WrongCounts wrong_counts(const Evaluation& evaluation, const MethodResult& method, const Truth& truth, Error error) {
  WrongCounts counts;
  for (const RecordedRun& run : method.runs) {
    counts.push_back(wrong_edges(run.edges, truth, evaluation.member_vertices.front(), error));
  }
  return counts;
}

OutputFile wrong_edges_csv(const Evaluation& evaluation, const Truth& truth) {
  std::string csv = "method,run,verifications,edges,wrong_edges,unlisted_edges\n";
  for (const MethodResult& method : evaluation.methods) {
    const WrongCounts wrong = wrong_counts(evaluation, method, truth, Error::kNotRight);
    const WrongCounts unlisted = wrong_counts(evaluation, method, truth, Error::kNotListed);
    for (std::size_t r = 0; r < method.runs.size(); ++r) {
      const RecordedRun& run = method.runs[r];
      const auto add = [&](std::uint64_t verifications, std::size_t edges) {
        csv += method.method + "," + std::to_string(r) + "," + std::to_string(verifications) + "," +
               std::to_string(edges) + "," + std::to_string(wrong[r][edges]) + "," +
               std::to_string(unlisted[r][edges]) + "\n";
      };
      add(0, 0);
      for (std::size_t i = 1; i <= run.edges.size(); ++i) {
        if (wrong[r][i] != wrong[r][i - 1]) add(run.edges[i - 1].cost.verifications, i);
      }
      add(run.cost.verifications, run.edges.size());
    }
  }
  return {"wrong-edges.csv", csv};
}

// The numbers of edges at which a count changes, and those just before: the corners of a staircase.
std::vector<std::uint64_t> corners(const std::vector<std::uint64_t>& counts) {
  std::vector<std::uint64_t> edges{0};
  for (std::uint64_t i = 1; i < counts.size(); ++i) {
    if (counts[i] == counts[i - 1]) continue;
    if (edges.back() != i - 1) edges.push_back(i - 1);
    edges.push_back(i);
  }
  return edges;
}

void add_wrong_panels(const Evaluation& evaluation, const Truth& truth, Error error, Chart& chart) {
  std::vector<WrongCounts> counts;
  double most = 1;
  for (const MethodResult& method : evaluation.methods) {
    counts.push_back(wrong_counts(evaluation, method, truth, error));
    for (const auto& of_run : counts.back()) most = std::max(most, static_cast<double>(of_run.back()));
  }
  const double least = least_on_axis(evaluation, CostAxis::kVerifications);
  for (const bool is_log : {false, true}) {
    ChartPanel panel;
    panel.x_title = is_log ? "verifications (logarithmic)" : "verifications";
    panel.y_title = error == Error::kNotRight ? "wrong edges" : "edges not even listed";
    panel.log_x = is_log;
    panel.x_least = least;
    panel.x_most = most_on_axis(evaluation, CostAxis::kVerifications);
    panel.y_most = most;
    for (std::size_t m = 0; m < evaluation.methods.size(); ++m) {
      panel.series.push_back(method_series(
          evaluation.methods[m], CostAxis::kVerifications, 0, least, corners(counts[m].front()),
          [&](std::size_t run, std::uint64_t count) { return static_cast<double>(counts[m][run][count]); }));
    }
    chart.panels.push_back(std::move(panel));
  }
}

OutputFile wrong_edges_svg(const Evaluation& evaluation, const Truth& truth, const std::string& pair) {
  Chart chart;
  chart.title = "Wrong edges over verifications";
  chart.subtitle = pair + "; right: " + truth.rule();
  chart.legend = legend_of(evaluation);
  chart.columns = 2;
  chart.panel_width_px = 450;
  chart.panel_height_px = 270;
  add_wrong_panels(evaluation, truth, Error::kNotRight, chart);
  if (truth.is_graded()) add_wrong_panels(evaluation, truth, Error::kNotListed, chart);
  return {"wrong-edges.svg", chart_svg(chart)};
}

OutputFile precision_recall_csv(const TruthResult& truth) {
  std::string csv = "score,threshold,accepted,right,precision,recall\n";
  const auto add = [&](const char* score, double sign, const std::vector<PrecisionRecall>& points) {
    for (const PrecisionRecall& point : points) {
      csv += std::string(score) + "," + number(sign * point.threshold) + "," + std::to_string(point.accepted) + "," +
             std::to_string(point.right) + "," + number(point.precision) + "," + number(point.recall) + "\n";
    }
  };
  add("inliers", 1, truth.by_inliers);
  add("log10_false_alarms", -1, truth.by_false_alarms);
  return {"precision-recall.csv", csv};
}

OutputFile precision_recall_svg(const TruthResult& truth, const std::string& pair) {
  const ChartStyle inliers{"#0072B2", ""}, alarms{"#D55E00", "7 3"}, precision{"#009E73", ""}, recall{"#CC79A7", "7 3"};
  Chart chart;
  chart.title = "Precision and recall of verified pairs";
  chart.subtitle = pair + "; right: " + truth.truth.rule();
  chart.legend = {{"all thresholds of inliers", inliers},
                  {"all thresholds of false alarms", alarms},
                  {"precision", precision},
                  {"recall", recall}};
  chart.columns = 3;
  chart.panel_width_px = 330;
  chart.panel_height_px = 310;
  ChartPanel against{.title = "precision against recall", .x_title = "recall", .y_title = "precision"};
  for (const auto& [points, style] : {std::pair{&truth.by_inliers, inliers}, {&truth.by_false_alarms, alarms}}) {
    ChartSeries series{.style = style};
    for (const PrecisionRecall& point : *points) series.points.push_back({point.recall, point.precision});
    against.series.push_back(std::move(series));
  }
  chart.panels.push_back(std::move(against));
  const auto over = [&](const std::string& name, const std::string& title, const std::vector<PrecisionRecall>& points,
                        double most) {
    ChartPanel panel{.title = name, .x_title = title, .y_title = "precision, recall", .x_most = most};
    ChartSeries p{.style = precision}, r{.style = recall};
    for (auto point = points.rbegin(); point != points.rend(); ++point) {
      if (point->threshold < 0 || point->threshold > most) continue;
      p.points.push_back({point->threshold, point->precision});
      r.points.push_back({point->threshold, point->recall});
    }
    panel.series = {std::move(p), std::move(r)};
    chart.panels.push_back(std::move(panel));
  };
  over("over inliers", "inliers at least", truth.by_inliers, 100);
  over("over false alarms", "\u2212log\u2081\u2080 of false alarms at least", truth.by_false_alarms, 60);
  return {"precision-recall.svg", chart_svg(chart)};
}

OutputFile localization_csv(const TruthResult& truth) {
  std::string csv = "k,recall_by_votes,recall_verified\n";
  for (const RecallAtK& recall : truth.localization) {
    csv += std::to_string(recall.k) + "," + number(recall.by_votes) + "," + number(recall.by_verified) + "\n";
  }
  return {"localization.csv", csv};
}

}  // namespace

std::vector<OutputFile> truth_figures(const Evaluation& evaluation, const TruthResult& truth, const std::string& pair) {
  return {wrong_edges_svg(evaluation, truth.truth, pair), wrong_edges_csv(evaluation, truth.truth),
          precision_recall_svg(truth, pair), precision_recall_csv(truth), localization_csv(truth)};
}

}  // namespace mapweld::server::evaluation
