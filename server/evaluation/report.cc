#include "server/evaluation/report.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <initializer_list>
#include <vector>

#include "client/drawing/svg.h"

namespace mapweld::server::evaluation {
namespace {

using drawing::shown;

std::string fixed(double value, int decimals) {
  char text[48];
  std::snprintf(text, sizeof text, "%.*f", decimals, value);
  return text;
}

// "12,883"
std::string grouped(double value) {
  std::string digits = fixed(value, 0);
  for (std::ptrdiff_t i = static_cast<std::ptrdiff_t>(digits.size()) - 3; i > (digits[0] == '-' ? 1 : 0); i -= 3) {
    digits.insert(static_cast<std::size_t>(i), ",");
  }
  return digits;
}

std::string percent(double share, int decimals = 0) { return fixed(100 * share, decimals) + " %"; }

// Three significant digits: "0.00312", "1.52", "40.1".
std::string seconds(double value) {
  if (value == 0) return "0";
  const int decimals = std::clamp(2 - static_cast<int>(std::floor(std::log10(std::abs(value)))), 0, 6);
  return fixed(value, decimals);
}

template <typename Format>
std::string cell(const Summary& summary, const Format& format) {
  if (summary.count == 0) return "-";
  std::string text = format(summary.mean);
  if (summary.count > 1) text += " ± " + format(summary.deviation);
  return text;
}

std::string row(std::initializer_list<std::string> cells) {
  std::string text = "|";
  for (const std::string& entry : cells) text += " " + entry + " |";
  return text + "\n";
}

std::string row(const std::vector<std::string>& cells) {
  std::string text = "|";
  for (const std::string& entry : cells) text += " " + entry + " |";
  return text + "\n";
}

std::string rule(std::size_t columns) {
  std::string text = "|---|";
  for (std::size_t i = 1; i < columns; ++i) text += "---:|";
  return text + "\n";
}

std::string name_of(const MethodResult& method) {
  std::string name = "`" + method.method + "`";
  if (method.runs.size() > 1) name += " (" + std::to_string(method.runs.size()) + " runs)";
  return name;
}

std::string what_was_merged(const ReportHead& head, const Evaluation& evaluation) {
  const EvaluationOptions& options = evaluation.options;
  const auto size = [&](std::size_t m) { return grouped(evaluation.member_vertices[m]); };
  std::string text = "# Merging `" + head.map_a + "` and `" + head.map_b + "`\n\n";
  text += "| | |\n|---|---|\n";
  text += row({"vertices", size(0) + " + " + size(1)});
  text += row({"edges within the maps", grouped(static_cast<double>(evaluation.inner_edges))});
  text += row({"candidates (pairs with `min_votes` or more)", grouped(static_cast<double>(evaluation.candidates))});
  text += row({"verified edges between the maps, when all candidates are",
               grouped(static_cast<double>(evaluation.all_edges.size()))});
  if (evaluation.confirmed_edges) {
    text += row({std::string("of them confirmed by the alias guard") +
                     (options.confirmed ? ": **these count** (`--confirmed`)" : ""),
                 grouped(static_cast<double>(*evaluation.confirmed_edges))});
  }
  text += row({"components of the finished merge", grouped(evaluation.components)});
  text += row({"**final component**: its largest one", grouped(evaluation.final_vertices) + " vertices"});
  text += row({"**final value**: its algebraic connectivity", shown(evaluation.final_connectivity, 6)});
  text += row({"joined vertices, independent joins at the end",
               grouped(evaluation.finished.joined_vertices) + ", " + grouped(evaluation.finished.independent_joins)});
  text += row({"parameters", "`min_votes` " + std::to_string(head.merge.min_votes) + ", votes `" +
                                 std::string(to_string(head.merge.votes)) + "`, `min_inliers` " +
                                 std::to_string(head.verifier.min_inliers) + ", `max_false_alarms` " +
                                 shown(head.verifier.max_false_alarms) + ", verifier `" + head.verifier_version + "`"});
  text += row({"seeds of the randomised methods",
               std::to_string(options.seed) + " .. " + std::to_string(options.seed + std::max(1u, options.runs) - 1)});
  text += "\nMade by `" + head.command + "`.\n\n";
  text +=
      "The final value is one and the same for all methods: lambda_2 of the finished merge on its largest "
      "component. Until that component is in one piece, lambda_2 on it is 0. The value after each edge is exact; "
      "the number of edges to a level is found by bisection, as lambda_2 on a fixed vertex set only grows. ";
  text += options.confirmed
              ? "The edges that count are those that the alias guard confirms in the end, each from its verification "
                "on, within the maps and between them; the finished merge is that of these.\n\n"
              : "Edges are verified edges throughout: the order of verification is compared, whatever a guard confirms "
                "of them.\n\n";
  if (options.memo) {
    text += "**Verdicts were shared between the methods (`--memo`): costs are counted in verifications only.**\n\n";
    return text;
  }
  text += "*Time* is processor time of the one thread that merges, votes included, maps and their word index (" +
          seconds(evaluation.index_s) +
          " s) already in memory; without checkpoints, and without the eigenvalues, which are computed afterwards. "
          "*Time with a verifier of " +
          shown(1000 * options.modelled_verifier_s) + " ms* is modelled: the measured time outside the verifier plus " +
          shown(1000 * options.modelled_verifier_s) +
          " ms for each verification. Verdicts were not shared between methods.\n\n";
  return text;
}

std::string level_tables(const Evaluation& evaluation) {
  const EvaluationOptions& options = evaluation.options;
  std::string text;
  for (std::size_t l = 0; l < options.levels.size(); ++l) {
    text += "## To " + percent(options.levels[l]) + " of the final value\n\n";
    std::vector<std::string> head{"method", "verifications", "of all"};
    if (!options.memo) {
      head.insert(head.end(),
                  {"time (s)", "time with a verifier of " + shown(1000 * options.modelled_verifier_s) + " ms (s)"});
    }
    head.insert(head.end(), {"verified edges", "joined vertices", "independent joins"});
    text += row(head) + rule(head.size());
    for (const MethodResult& method : evaluation.methods) {
      const LevelCost& cost = method.levels[l];
      std::string name = name_of(method);
      if (cost.reached < method.runs.size()) name += ", reached by " + std::to_string(cost.reached);
      const auto candidates = static_cast<double>(std::max<std::uint64_t>(1, evaluation.candidates));
      std::vector<std::string> cells{name, cell(cost.verifications, grouped),
                                     cost.reached == 0 ? "-" : percent(cost.verifications.mean / candidates, 1)};
      if (!options.memo) {
        cells.push_back(cell(cost.time_s, seconds));
        cells.push_back(cell(cost.modelled_time_s, seconds));
      }
      cells.push_back(cell(cost.edges, grouped));
      cells.push_back(cell(cost.joined_vertices, grouped));
      cells.push_back(cell(cost.independent_joins, grouped));
      text += row(cells);
    }
    text += "\n";
  }
  return text;
}

std::string limit_table(const Evaluation& evaluation) {
  std::string text = "## Against the clairvoyant\n\n";
  text +=
      "Verifications to each level, and in brackets how many times the clairvoyant's. The *clairvoyant* knows "
      "beforehand "
      "which candidates pass" +
      std::string(evaluation.options.confirmed ? " and are confirmed in the end" : "") +
      ", and verifies only the edges that it wants: first those that join, then always the one between the ends that "
      "the Fiedler vector holds farthest apart. It is near the least that is possible, not a bound; *no order* with "
      "fewer edges than the last row reaches the level (MAC's relaxation).\n\n";
  std::vector<std::string> head{"method"}, clairvoyant{"**clairvoyant**"}, least{"no order below"};
  for (const LevelLimit& limit : evaluation.limit.levels) {
    head.push_back(percent(limit.level));
    clairvoyant.push_back(limit.clairvoyant ? grouped(static_cast<double>(limit.clairvoyant->edges)) : "-");
    least.push_back(grouped(static_cast<double>(limit.least_edges)));
  }
  text += row(head) + rule(head.size()) + row(clairvoyant);
  for (const MethodResult& method : evaluation.methods) {
    std::vector<std::string> cells{name_of(method)};
    for (std::size_t l = 0; l < method.levels.size(); ++l) {
      const LevelCost& cost = method.levels[l];
      std::string entry = cost.reached == 0 ? "-" : grouped(cost.verifications.mean);
      const auto ratio = to_clairvoyant(evaluation.limit.levels[l], cost.verifications.mean);
      if (cost.reached > 0 && ratio) entry += " (" + fixed(*ratio, *ratio < 100 ? 1 : 0) + ")";
      cells.push_back(entry);
    }
    text += row(cells);
  }
  return text + row(least) + "\n";
}

std::string share_table(const Evaluation& evaluation) {
  const EvaluationOptions& options = evaluation.options;
  const std::string share = percent(options.share_of_baseline);
  std::string text = "## At " + share + " of brute force's cost (figure 5)\n\n";
  text += "lambda_2 on the final component, in per cent of the final value.\n\n";
  std::vector<CostAxis> axes{CostAxis::kVerifications};
  std::vector<std::string> head{"method", share + " of its verifications"};
  if (!options.memo) {
    axes = {CostAxis::kTime, CostAxis::kVerifications, CostAxis::kModelledTime};
    head = {"method", share + " of its time", share + " of its verifications",
            share + " of its time with a verifier of " + shown(1000 * options.modelled_verifier_s) + " ms"};
  }
  head.insert(head.end(), {"joined vertices then", "independent joins then"});
  text += row(head) + rule(head.size());
  for (const MethodResult& method : evaluation.methods) {
    std::vector<std::string> cells{name_of(method)};
    const auto at = [&](CostAxis axis) { return *std::ranges::find(method.at_share, axis, &QualityAtShare::axis); };
    for (const CostAxis axis : axes) {
      cells.push_back(cell(at(axis).connectivity, [](double value) { return percent(value, 1); }));
    }
    cells.push_back(cell(at(axes.front()).joined_vertices, grouped));
    cells.push_back(cell(at(axes.front()).independent_joins, grouped));
    text += row(cells);
  }
  return text + "\n";
}

std::string whole_table(const Evaluation& evaluation) {
  std::string text = "## Whole merges\n\n";
  std::vector<std::string> head{"method", "verifications"};
  if (!evaluation.options.memo) head.insert(head.end(), {"time (s)", "of it in the verifier (s)", "modelled time (s)"});
  head.emplace_back("exploration ended after");
  head.emplace_back("ends with all verified edges");
  text += row(head) + rule(head.size());
  for (const MethodResult& method : evaluation.methods) {
    std::vector<std::string> cells{name_of(method), cell(method.verifications, grouped)};
    if (!evaluation.options.memo) {
      std::vector<double> verifier_s;
      for (const RecordedRun& run : method.runs) verifier_s.push_back(run.cost.verifier_s);
      cells.push_back(cell(method.time_s, seconds));
      cells.push_back(cell(summary_of(verifier_s), seconds));
      cells.push_back(cell(method.modelled_time_s, seconds));
    }
    const RecordedRun& first = method.runs.front();
    std::string exploration = "-";
    if (first.exploration_end) {
      const Cost& end = *first.exploration_end;
      const std::uint64_t edges =
          edges_within(first, CostAxis::kVerifications, 0, static_cast<double>(end.verifications));
      exploration = grouped(static_cast<double>(edges)) + " verified edges, " +
                    grouped(static_cast<double>(end.verifications)) + " verifications";
      if (!evaluation.options.memo) exploration += ", " + seconds(end.elapsed_s) + " s";
    }
    cells.push_back(exploration);
    cells.emplace_back(method.is_complete ? "yes" : "**no**");
    text += row(cells);
  }
  return text + "\n";
}

std::string threshold_text(const std::optional<SuggestedThresholds>& suggested) {
  if (!suggested) return "none reaches it";
  return "`min_inliers` " + std::to_string(suggested->min_inliers) + ", `max_false_alarms` 1e" +
         std::to_string(suggested->log10_max_false_alarms) + ": recall " + percent(suggested->result.recall, 1) + ", " +
         grouped(static_cast<double>(suggested->result.accepted)) + " edges, precision " +
         percent(suggested->result.precision, 2);
}

std::string full_precision_text(const std::vector<PrecisionRecall>& points, const char* what, double sign) {
  const auto point = at_full_precision(points);
  if (!point) return "none: the most certain pair is wrong";
  return percent(point->recall, 1) + " (" + what + " " + shown(sign * point->threshold, 4) + ")";
}

std::string truth_section(const Evaluation& evaluation, const TruthResult& result) {
  const Truth& truth = result.truth;
  const auto count = [](std::uint64_t n) { return grouped(static_cast<double>(n)); };
  std::string text = "## Against the truth\n\nRight: " + truth.rule() + ". The file has " + count(truth.lines()) +
                     " lines, " + count(truth.unknown_lines()) + " of them about images that are no vertex.";
  if (!truth.is_complete()) {
    text += " Pairs that it does not list count as wrong, be they right: precision is a lower bound.";
  }
  text += "\n\n| | |\n|---|---|\n";
  text += row({"right pairs of vertices", count(truth.right_pairs())});
  text += row({"of them candidates", count(result.right_candidates) + " of " + count(result.candidates)});
  text += row({"accepted with the parameters above",
               count(result.chosen.accepted) + ", right " + count(result.chosen.right) + ": precision " +
                   percent(result.chosen.precision, 2) + ", recall " + percent(result.chosen.recall, 1)});
  if (truth.is_graded()) text += row({"accepted, and not even listed", count(result.unlisted)});
  text += row({"images of the second map whose place the first has", count(result.placed)});
  text += row({"of them with a right edge",
               count(result.rightly_joined) + ": " +
                   percent(result.placed == 0 ? 0.0 : static_cast<double>(result.rightly_joined) / result.placed, 1)});
  if (truth.is_graded()) {
    const double joined = result.joinable == 0 ? 0.0 : static_cast<double>(result.joinable_joined) / result.joinable;
    text += row({"images of the second map that share " + percent(kJoinableShare) + " with one of the first and have " +
                     std::to_string(kJoinableFeatures) + " features, with a right edge",
                 count(result.joinable_joined) + " of " + count(result.joinable) + ": " + percent(joined, 1)});
  }
  text += row({"lambda_2 with the right edges only, of the final value", percent(result.right_connectivity, 1)});
  text += row({"recall at 100 % precision, inliers alone", full_precision_text(result.by_inliers, "at least", 1)});
  text += row({"recall at 100 % precision, false alarms alone",
               full_precision_text(result.by_false_alarms, "log10 at most", -1)});
  text += row({"suggested for 100 % precision here", threshold_text(result.without_error)});
  text += row({"suggested for 99.9 % precision here", threshold_text(result.nearly)});
  text += "\nRecall counts all right pairs, those that share too few words to be candidates included.\n\n";

  text += "### Localizing the second map's images in the first: recall@K\n\n";
  std::vector<std::string> head{"K"}, votes{"by votes"}, verified{"accepted, by inliers"};
  for (const RecallAtK& recall : result.localization) {
    head.push_back(std::to_string(recall.k));
    votes.push_back(percent(recall.by_votes, 1));
    verified.push_back(percent(recall.by_verified, 1));
  }
  text += row(head) + rule(head.size()) + row(votes) + row(verified) + "\n";

  text +=
      "### Wrong edges along the way\n\nShare of all verifications, and how many of the edges by then are wrong.\n\n";
  const std::vector<double> shares{0.01, 0.05, 0.1, 0.25, 0.5, 1};
  head = {"method"};
  for (const double share : shares) head.push_back(percent(share));
  text += row(head) + rule(head.size());
  for (const MethodResult& method : evaluation.methods) {
    std::vector<std::vector<std::uint64_t>> wrong, unlisted;
    for (const RecordedRun& run : method.runs) {
      wrong.push_back(wrong_edges(run.edges, truth, evaluation.member_vertices.front()));
      unlisted.push_back(wrong_edges(run.edges, truth, evaluation.member_vertices.front(), Error::kNotListed));
    }
    std::vector<std::string> cells{name_of(method)};
    for (const double share : shares) {
      std::vector<double> counts, not_listed, edges;
      for (std::size_t r = 0; r < method.runs.size(); ++r) {
        const std::uint64_t taken = edges_within(method.runs[r], CostAxis::kVerifications, 0,
                                                 share * static_cast<double>(evaluation.candidates));
        counts.push_back(static_cast<double>(wrong[r][taken]));
        not_listed.push_back(static_cast<double>(unlisted[r][taken]));
        edges.push_back(static_cast<double>(taken));
      }
      const auto one = [](double value) { return fixed(value, value == std::round(value) ? 0 : 1); };
      std::string text_of_share = one(summary_of(counts).mean);
      if (truth.is_graded()) text_of_share += " (" + one(summary_of(not_listed).mean) + ")";
      cells.push_back(text_of_share + " of " + one(summary_of(edges).mean));
    }
    text += row(cells);
  }
  return text + "\n";
}

}  // namespace

std::string markdown_report(const ReportHead& head, const Evaluation& evaluation, const TruthResult* truth) {
  std::string text = what_was_merged(head, evaluation) + share_table(evaluation) + limit_table(evaluation) +
                     level_tables(evaluation) + whole_table(evaluation);
  if (truth != nullptr) text += truth_section(evaluation, *truth);
  return text;
}

}  // namespace mapweld::server::evaluation
