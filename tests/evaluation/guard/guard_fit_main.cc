// Fits the weights of EvidenceModel, and shows them on cases that they were not fitted on (docs/alias-guard.md).
//
//   guard_fit --cache FOLDER
//   guard_fit --cache FOLDER --fit museum-region twin-2 --test office-two-rings
// Shapes that are no weights (half_tested, common_floor, usual_similarity, full, dense, near_view) are taken as given.
#include <algorithm>
#include <cstdio>
#include <map>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>

#include "tests/evaluation/guard/guard_counts.h"
#include "tests/evaluation/guard/logistic_fit.h"
#include "tests/evaluation/tool_main.h"

namespace mapweld::evaluation {
namespace {

// One verified edge with known truth.
struct Observation {
  std::string group;  // edges of one group and truth weigh so many together
  bool is_inner = false;
  bool is_right = false;
  EdgeSigns signs;
};

struct Asked {
  std::string cache;
  std::vector<std::string> fit{
      "museum-region",        "office-two-runs",       "corridor-two-laps",     "twin-2",
      "twin-2a-twin-3a",      "tower-04.1-tower-17.1", "tower-04.1-tower-17.2", "tower-04.2-tower-17.1",
      "tower-04.2-tower-17.2"};
  std::vector<std::string> test{
      "office-two-rings",     "studio", "magasin", "twin-3", "twin-2b-twin-3b", "tower-09.1-tower-19.1",
      "tower-09.2-tower-19.1"};
  std::vector<std::string> fit_inner{"museum-region", "office-two-runs", "corridor-two-laps", "twins-2a+3a-2b"};
  std::vector<std::string> test_inner{"office-two-rings", "twins-2a+3b-2b", "towers-17.1+19.1-17.2+04.1"};
  double most_a_group = 100, ridge = 0.3;
  EvidenceModel shape;
  int threads = 2;
};

std::string group_of(const GuardCase& c, bool is_inner) { return (is_inner ? "inside " : "") + c.group; }

std::vector<Observation> observations(const Asked& asked, const std::vector<std::string>& names, bool is_inner) {
  std::vector<Observation> found;
  const auto all = real_cases();
  for (const std::string& name : names) {
    const auto c = std::ranges::find(all, name, &GuardCase::name);
    if (c == all.end()) throw std::invalid_argument("no case " + name);
    const JudgedMerge judged = judged_merge(*c, asked.cache, asked.threads);
    const GuardRun run = run_guard(judged, {});
    const auto& truth = is_inner ? judged.inner_truth : judged.inter_truth;
    const auto& verdicts = is_inner ? run.inner : run.inter;
    for (std::size_t e = 0; e < verdicts.size(); ++e) {
      // Along one corridor of the twin storeys nobody knows how far one sees; elsewhere edges were looked at.
      if (truth[e] == Truth::kUnknown && name.starts_with("twin")) continue;
      found.push_back({group_of(*c, is_inner), is_inner, truth[e] != Truth::kWrong, verdicts[e].evidence.signs});
    }
  }
  return found;
}

std::vector<Observation> both(std::vector<Observation> one, const std::vector<Observation>& other) {
  one.insert(one.end(), other.begin(), other.end());
  return one;
}

EvidenceModel fitted(const std::vector<Observation>& seen, const Asked& asked) {
  EvidenceModel unit = asked.shape;
  unit.prior = unit.inner_prior = 0;
  unit.rarity = unit.fullness = unit.shortfall = unit.nearness = 1;
  std::map<std::pair<std::string, bool>, double> count;
  for (const Observation& o : seen) count[{o.group, o.is_right}] += 1;
  const auto n = static_cast<Eigen::Index>(seen.size());
  Eigen::MatrixXd x(n, 6);
  Eigen::VectorXd y(n), weight(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const Observation& o = seen[static_cast<std::size_t>(i)];
    const EvidenceParts parts = weigh(o.signs, unit, o.is_inner);
    x.row(i) << 1, o.is_inner ? 1 : 0, parts.rarity, parts.fullness, parts.shortfall, parts.nearness;
    y[i] = o.is_right ? 1 : 0;
    weight[i] = std::min(1.0, asked.most_a_group / count[{o.group, o.is_right}]);
  }
  const Eigen::VectorXd w = logistic_fit(x, y, weight, asked.ridge);
  EvidenceModel model = asked.shape;
  model.prior = w[0];
  model.inner_prior = w[0] + w[1];
  model.rarity = w[2];
  model.fullness = w[3];
  model.shortfall = w[4];
  model.nearness = w[5];
  return model;
}

void print_model(const char* title, const EvidenceModel& m) {
  std::printf("%s: prior %.2f, inside %.2f, rarity %.2f, fullness %.2f, shortfall %.2f, nearness %.2f\n", title,
              m.prior, m.inner_prior, m.rarity, m.fullness, m.shortfall, m.nearness);
}

// The chance that a right edge is above a wrong one.
double area(const std::vector<double>& right, std::vector<double> wrong) {
  std::ranges::sort(wrong);
  double above = 0;
  for (const double r : right) {
    const auto equal = std::ranges::equal_range(wrong, r);
    above += static_cast<double>(equal.begin() - wrong.begin()) + 0.5 * static_cast<double>(equal.size());
  }
  return above / (static_cast<double>(right.size()) * static_cast<double>(wrong.size()));
}

// By their own signs alone, without what edges pass on.
void report(const char* title, const std::vector<Observation>& seen, const EvidenceModel& model) {
  std::map<std::string, std::vector<double>> right, wrong;
  std::vector<double> all_wrong;
  std::vector<std::string> groups;
  for (const Observation& o : seen) {
    const double odds = weigh(o.signs, model, o.is_inner).sum();
    (o.is_right ? right : wrong)[o.group].push_back(odds);
    if (!o.is_right) all_wrong.push_back(odds);
    if (std::ranges::find(groups, o.group) == groups.end()) groups.push_back(o.group);
  }
  const double greatest = all_wrong.empty() ? 0 : *std::ranges::max_element(all_wrong);
  std::printf(
      "\n%s (greatest wrong of all: %.2f)\n\n| group | right | wrong | greatest wrong | right above every wrong one %% "
      "| right at 0.9 %% | wrong at 0.9 %% | AUC against all wrong |\n|---|---|---|---|---|---|---|---|\n",
      title, greatest);
  const double nine = log_odds_of(0.9);
  for (const std::string& group : groups) {
    const auto& r = right[group];
    const auto& w = wrong[group];
    const auto share = [](const std::vector<double>& of, double least) {
      return of.empty() ? 0
                        : 100.0 * static_cast<double>(std::ranges::count_if(of, [&](double x) { return x > least; })) /
                              static_cast<double>(of.size());
    };
    std::printf("| %s | %zu | %zu | ", group.c_str(), r.size(), w.size());
    w.empty() ? std::printf("- |") : std::printf("%.2f |", *std::ranges::max_element(w));
    r.empty() ? std::printf(" - | - |") : std::printf(" %.1f | %.1f |", share(r, greatest), share(r, nine));
    w.empty() ? std::printf(" - |") : std::printf(" %.2f |", share(w, nine));
    r.empty() || all_wrong.empty() ? std::printf(" - |\n") : std::printf(" %.4f |\n", area(r, all_wrong));
  }
}

int run(int argc, char** argv) {
  CLI::App app{"Fits the weights of the alias guard's model.", "guard_fit"};
  Asked asked;
  app.add_option("--cache", asked.cache, "where made merges are kept")->required()->check(CLI::ExistingDirectory);
  app.add_option("--fit", asked.fit, "cases whose edges between maps it is fitted on");
  app.add_option("--fit-inner", asked.fit_inner, "cases whose inner edges it is fitted on");
  app.add_option("--test", asked.test, "cases that it is shown on");
  app.add_option("--test-inner", asked.test_inner, "cases whose inner edges it is shown on");
  app.add_option("--most-a-group", asked.most_a_group, "so many edges of one group and truth weigh fully");
  app.add_option("--ridge", asked.ridge, "how strongly weights are held back");
  app.add_option("--half-tested", asked.shape.half_tested, "EvidenceModel");
  app.add_option("--full", asked.shape.full, "EvidenceModel");
  app.add_option("--dense", asked.shape.dense, "EvidenceModel");
  app.add_option("--threads", asked.threads, "for making merges; change no figure")->check(CLI::PositiveNumber);
  CLI11_PARSE(app, argc, argv);
  const auto fit = both(observations(asked, asked.fit, false), observations(asked, asked.fit_inner, true));
  const auto test = both(observations(asked, asked.test, false), observations(asked, asked.test_inner, true));
  const EvidenceModel half = fitted(fit, asked), whole = fitted(both(fit, test), asked);
  print_model("fitted", half);
  print_model("fitted on all", whole);
  print_model("shipped", EvidenceModel());
  report("Fitted weights, cases that they were fitted on", fit, half);
  report("Fitted weights, held out", test, half);
  report("Shipped weights, all", both(fit, test), EvidenceModel());
  return 0;
}

}  // namespace
}  // namespace mapweld::evaluation

int main(int argc, char** argv) {
  return mapweld::evaluation::tool_main("guard_fit", mapweld::evaluation::run, argc, argv);
}
