#include "server/evaluation/figures.h"

#include <algorithm>
#include <cstdio>
#include <iterator>
#include <optional>
#include <utility>

#include "client/drawing/svg.h"
#include "server/evaluation/limit_series.h"
#include "server/evaluation/method_series.h"

namespace mapweld::server::evaluation {
namespace {

std::string number(double value) { return drawing::shown(value, 9); }
std::string number(std::uint64_t value) { return std::to_string(value); }

std::string percent(double share) {
  char text[32];
  std::snprintf(text, sizeof text, "%.0f %%", 100 * share);
  return text;
}

struct AxisText {
  const char* stem;   // of the file
  const char* csv;    // in a CSV
  std::string title;  // on an axis
  std::string share;  // "of brute force's ..."
};

AxisText text_of(CostAxis axis, double verifier_s) {
  const std::string ms = drawing::shown(verifier_s * 1000) + " ms";
  switch (axis) {
    case CostAxis::kVerifications:
      return {"verifications", "verifications", "verifications", "verifications"};
    case CostAxis::kTime:
      return {"time", "time_s", "processor time (s)", "time"};
    case CostAxis::kModelledTime:
      break;
  }
  return {"modelled-time", "modelled_time_s", "time with a verifier of " + ms + " (s)",
          "time with a verifier of " + ms};
}

std::vector<CostAxis> axes_of(const Evaluation& evaluation) {
  if (evaluation.options.memo) return {CostAxis::kVerifications};
  return {CostAxis::kTime, CostAxis::kVerifications, CostAxis::kModelledTime};
}

double share_of(double value, double whole) { return whole > 0 ? value / whole : 0; }

// ---- figure 5

std::string figure_5_csv(const Evaluation& evaluation) {
  std::string csv =
      "method,cost,budget,runs,connectivity_mean,connectivity_sd,joined_vertices_mean,joined_vertices_sd,"
      "independent_joins_mean,independent_joins_sd\n";
  for (const MethodResult& method : evaluation.methods) {
    for (const QualityAtShare& quality : method.at_share) {
      if (evaluation.options.memo && quality.axis != CostAxis::kVerifications) continue;
      csv += method.method + "," + text_of(quality.axis, 0).csv + "," + number(quality.budget) + "," +
             number(std::uint64_t{quality.connectivity.count});
      for (const Summary& summary : {quality.connectivity, quality.joined_vertices, quality.independent_joins}) {
        csv += "," + number(summary.mean) + "," + number(summary.deviation);
      }
      csv += "\n";
    }
  }
  return csv;
}

std::string figure_5_svg(const Evaluation& evaluation, const std::string& pair) {
  BarChart chart;
  chart.title = "Quality at " + percent(evaluation.options.share_of_baseline) + " of brute force's cost";
  chart.subtitle = pair + "; bars: mean, error bars: one standard deviation of repeated runs";
  chart.legend = legend_of(evaluation);
  chart.y_title = "\u03BB\u2082 / final \u03BB\u2082 (%)";
  chart.y_most = 100;
  for (const CostAxis axis : axes_of(evaluation)) {
    const AxisText text = text_of(axis, evaluation.options.modelled_verifier_s);
    BarGroup group;
    group.name = {percent(evaluation.options.share_of_baseline) + " of brute force's", text.share};
    for (const MethodResult& method : evaluation.methods) {
      const auto quality = std::ranges::find(method.at_share, axis, &QualityAtShare::axis);
      const double share = 100 * quality->connectivity.mean;
      group.bars.push_back({style_of_method(method.method), share, 100 * quality->connectivity.deviation,
                            drawing::shown(share, share >= 10 ? 3 : 2)});
    }
    chart.groups.push_back(std::move(group));
  }
  return bar_chart_svg(chart);
}

// ---- figure 6

std::string figure_6_csv(const Evaluation& evaluation) {
  std::string csv =
      "method,run,seed,edges,verifications,time_s,modelled_time_s,connectivity,normalised_connectivity,"
      "joined_vertices,independent_joins\n";
  const double verifier_s = evaluation.options.modelled_verifier_s;
  for (const MethodResult& method : evaluation.methods) {
    for (std::size_t i = 0; i < method.runs.size(); ++i) {
      const RecordedRun& run = method.runs[i];
      const auto add = [&](const CurvePoint& point, const Cost& cost) {
        csv += method.method + "," + number(std::uint64_t{i}) + "," + number(run.seed) + "," + number(point.edges) +
               "," + number(cost.verifications) + ",";
        if (!evaluation.options.memo) {
          csv += number(cost.elapsed_s) + "," + number(on_axis(cost, CostAxis::kModelledTime, verifier_s));
        } else {
          csv += ",";
        }
        csv += "," + number(point.connectivity) + "," +
               number(share_of(point.connectivity, evaluation.final_connectivity)) + "," +
               number(std::uint64_t{point.joined_vertices}) + "," + number(std::uint64_t{point.independent_joins}) +
               "\n";
      };
      for (const CurvePoint& point : method.curves[i]) add(point, cost_of(run, point.edges));
      add(method.curves[i].back(), run.cost);
    }
  }
  const auto add_limit = [&](const char* name, std::uint64_t edges, double connectivity) {
    csv += std::string(name) + ",0,," + number(edges) + "," + number(edges) + ",,," + number(connectivity) + "," +
           number(share_of(connectivity, evaluation.final_connectivity)) + ",";
  };
  for (const CurvePoint& point : evaluation.limit.clairvoyant) {
    add_limit("clairvoyant", point.edges, point.connectivity);
    csv += number(std::uint64_t{point.joined_vertices}) + "," + number(std::uint64_t{point.independent_joins}) + "\n";
  }
  for (const BoundPoint& point : evaluation.limit.bound) {
    add_limit("bound", point.edges, point.connectivity);
    csv += ",\n";
  }
  return csv;
}

struct Metric {
  std::string title;
  double whole;
  double (*value)(const CurvePoint&);
};

std::string figure_6_svg(const Evaluation& evaluation, const std::string& pair, CostAxis axis) {
  const double verifier_s = evaluation.options.modelled_verifier_s;
  const AxisText text = text_of(axis, verifier_s);
  const CurvePoint& finished = evaluation.finished;
  const std::vector<Metric> metrics{{"\u03BB\u2082 / final \u03BB\u2082", evaluation.final_connectivity,
                                     [](const CurvePoint& p) { return p.connectivity; }},
                                    {"joined vertices / final", static_cast<double>(finished.joined_vertices),
                                     [](const CurvePoint& p) { return static_cast<double>(p.joined_vertices); }},
                                    {"independent joins / final", static_cast<double>(finished.independent_joins),
                                     [](const CurvePoint& p) { return static_cast<double>(p.independent_joins); }}};
  Chart chart;
  chart.title = "Merging over " + text.title;
  chart.subtitle = pair + "; left: linear, right: the same on a logarithmic axis; dashed: 90 %";
  chart.legend = legend_of(evaluation);
  chart.columns = 2;
  chart.panel_width_px = 450;
  chart.panel_height_px = 270;
  const bool has_limit = axis == CostAxis::kVerifications;
  const double least = has_limit ? 1 : least_on_axis(evaluation, axis);
  if (has_limit) std::ranges::move(legend_of_limit(), std::back_inserter(chart.legend));
  for (const Metric& metric : metrics) {
    for (const bool is_log : {false, true}) {
      ChartPanel panel;
      panel.x_title = text.title;
      panel.y_title = metric.title;
      panel.log_x = is_log;
      panel.x_least = least;
      panel.x_most = most_on_axis(evaluation, axis);
      panel.guides = {0.9};
      if (has_limit && &metric == &metrics.front() && evaluation.final_connectivity > 0) {
        panel.series.push_back(bound_series(evaluation.limit, evaluation.final_connectivity));
      }
      if (has_limit) {
        panel.series.push_back(clairvoyant_series(
            evaluation.limit, [&](const CurvePoint& point) { return share_of(metric.value(point), metric.whole); }));
      }
      for (const MethodResult& method : evaluation.methods) {
        std::vector<std::uint64_t> edges;
        for (const CurvePoint& point : method.curves.front()) edges.push_back(point.edges);
        panel.series.push_back(
            method_series(method, axis, verifier_s, least, edges, [&](std::size_t run, std::uint64_t count) {
              return share_of(metric.value(interpolated(method.curves[run], count)), metric.whole);
            }));
      }
      chart.panels.push_back(std::move(panel));
    }
  }
  return chart_svg(chart);
}

// ---- levels

std::string levels_csv(const Evaluation& evaluation) {
  std::string csv =
      "method,level,runs,reached,verifications_mean,verifications_sd,time_s_mean,time_s_sd,modelled_time_s_mean,"
      "modelled_time_s_sd,edges_mean,edges_sd,joined_vertices_mean,joined_vertices_sd,independent_joins_mean,"
      "independent_joins_sd,clairvoyant_edges,to_clairvoyant,least_edges\n";
  // The columns about the limit, beside this many verifications.
  const auto add_limit = [&](const LevelLimit& limit, std::optional<double> verifications) {
    const std::optional<double> ratio = verifications ? to_clairvoyant(limit, *verifications) : std::nullopt;
    csv += "," + (limit.clairvoyant ? number(limit.clairvoyant->edges) : "") + "," + (ratio ? number(*ratio) : "") +
           "," + number(limit.least_edges) + "\n";
  };
  for (const MethodResult& method : evaluation.methods) {
    for (std::size_t l = 0; l < method.levels.size(); ++l) {
      const LevelCost& cost = method.levels[l];
      csv += method.method + "," + number(cost.level) + "," + number(std::uint64_t{method.runs.size()}) + "," +
             number(std::uint64_t{cost.reached});
      const auto add = [&](const Summary& summary, bool is_time) {
        const bool is_shown = summary.count > 0 && !(is_time && evaluation.options.memo);
        csv += is_shown ? "," + number(summary.mean) + "," + number(summary.deviation) : ",,";
      };
      add(cost.verifications, false);
      add(cost.time_s, true);
      add(cost.modelled_time_s, true);
      add(cost.edges, false);
      add(cost.joined_vertices, false);
      add(cost.independent_joins, false);
      add_limit(evaluation.limit.levels[l], cost.reached > 0 ? std::optional(cost.verifications.mean) : std::nullopt);
    }
  }
  for (const LevelLimit& limit : evaluation.limit.levels) {
    const auto& reached = limit.clairvoyant;
    csv += "clairvoyant," + number(limit.level) + (reached ? ",1,1," : ",1,0,");
    const auto count = [](std::uint64_t n) { return number(n) + ",0"; };
    csv += reached ? count(reached->edges) + ",,,,," + count(reached->edges) + "," + count(reached->joined_vertices) +
                         "," + count(reached->independent_joins)
                   : ",,,,,,,,,,,";
    add_limit(limit, reached ? std::optional(static_cast<double>(reached->edges)) : std::nullopt);
  }
  return csv;
}

// ---- figure 7

// How long the exploration phase lasts.
Cost exploration(const Evaluation& evaluation) {
  for (const MethodResult& method : evaluation.methods) {
    if (method.method == "quickconnect" && method.runs.front().exploration_end) {
      return *method.runs.front().exploration_end;
    }
  }
  Cost cost = evaluation.find(kBaseline)->runs.front().cost;
  cost.verifications =
      static_cast<std::uint64_t>(evaluation.options.share_of_baseline * static_cast<double>(cost.verifications));
  cost.elapsed_s *= evaluation.options.share_of_baseline;
  return cost;
}

CostAxis axis_of_figure_7(const Evaluation& evaluation) {
  return evaluation.options.memo ? CostAxis::kVerifications : CostAxis::kTime;
}

std::uint64_t edges_in_exploration(const Evaluation& evaluation, const RecordedRun& run) {
  const CostAxis axis = axis_of_figure_7(evaluation);
  return edges_within(run, axis, 0, on_axis(exploration(evaluation), axis, 0));
}

std::string figure_7_csv(const Evaluation& evaluation) {
  std::string csv = "method,run,order,verifications,time_s,inliers,votes\n";
  for (const MethodResult& method : evaluation.methods) {
    for (std::size_t r = 0; r < method.runs.size(); ++r) {
      const RecordedRun& run = method.runs[r];
      const std::uint64_t count = edges_in_exploration(evaluation, run);
      for (std::uint64_t i = 0; i < count; ++i) {
        const RecordedEdge& edge = run.edges[i];
        csv += method.method + "," + number(std::uint64_t{r}) + "," + number(i + 1) + "," +
               number(edge.cost.verifications) + "," + (evaluation.options.memo ? "" : number(edge.cost.elapsed_s)) +
               "," + number(std::uint64_t{edge.inliers}) + "," + number(std::uint64_t{edge.votes}) + "\n";
      }
    }
  }
  return csv;
}

std::string figure_7_svg(const Evaluation& evaluation, const std::string& pair) {
  constexpr std::size_t kWindow = 25;
  const CostAxis axis = axis_of_figure_7(evaluation);
  Chart chart;
  chart.title = "Weights of the edges while QuickConnect explores";
  chart.subtitle = pair + "; dots: edges in order, line: mean of " + std::to_string(kWindow) +
                   " edges, randomised methods: first run";
  chart.columns = 2;
  chart.panel_width_px = 450;
  chart.panel_height_px = 240;
  double heaviest = 1;
  for (const RecordedEdge& edge : evaluation.all_edges) heaviest = std::max<double>(heaviest, edge.inliers);
  for (const MethodResult& method : evaluation.methods) {
    const RecordedRun& run = method.runs.front();
    const std::uint64_t count = edges_in_exploration(evaluation, run);
    ChartPanel panel;
    panel.title = method.method + ": " + std::to_string(count) + (count == 1 ? " edge" : " edges");
    panel.x_title = text_of(axis, 0).title;
    panel.y_title = "weight (inliers)";
    panel.x_most = std::max(on_axis(exploration(evaluation), axis, 0), 1e-9);
    panel.y_most = heaviest;
    ChartSeries dots{.style = style_of_method(method.method), .dots = true};
    ChartSeries mean{.style = {drawing::kInk, ""}};
    double sum = 0;
    for (std::uint64_t i = 0; i < count; ++i) {
      dots.points.push_back({on_axis(run.edges[i].cost, axis, 0), static_cast<double>(run.edges[i].inliers)});
      sum += run.edges[i].inliers;
      if (i >= kWindow) sum -= run.edges[i - kWindow].inliers;
      if (i + 1 >= kWindow) mean.points.push_back({dots.points.back().x, sum / kWindow});
    }
    panel.series = {std::move(dots), std::move(mean)};
    chart.panels.push_back(std::move(panel));
  }
  return chart_svg(chart);
}

}  // namespace

std::vector<OutputFile> figures(const Evaluation& evaluation, const std::string& pair) {
  std::vector<OutputFile> files{
      {"figure-5.svg", figure_5_svg(evaluation, pair)}, {"figure-5.csv", figure_5_csv(evaluation)},
      {"figure-6.csv", figure_6_csv(evaluation)},       {"levels.csv", levels_csv(evaluation)},
      {"figure-7.svg", figure_7_svg(evaluation, pair)}, {"figure-7.csv", figure_7_csv(evaluation)}};
  for (const CostAxis axis : axes_of(evaluation)) {
    files.push_back({std::string("figure-6-") + text_of(axis, 0).stem + ".svg", figure_6_svg(evaluation, pair, axis)});
  }
  return files;
}

}  // namespace mapweld::server::evaluation
