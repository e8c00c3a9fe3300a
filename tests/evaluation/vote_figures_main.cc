// What votes find on the real places, rule by rule: candidates of a merge beside what a careful matcher joins, and
// localization (docs/votes.md).
//
//   vote_figures --careful FOLDER                        FOLDER/<place>.csv as careful_matcher writes them
//   vote_figures --careful FOLDER --places museum-region --rules min signatures
#include <algorithm>
#include <array>
#include <atomic>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <list>
#include <map>
#include <set>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include <CLI/CLI.hpp>

#include "core/feature/decode.h"
#include "core/feature/extractor.h"
#include "core/geometry/epipolar_verifier.h"
#include "core/mapping/mapper.h"
#include "core/retrieval/voting.h"
#include "core/vocabulary/appearance_vector.h"
#include "core/vocabulary/vocabulary.h"
#include "tests/core/mapping/scene_map.h"
#include "tests/evaluation/careful_pairs.h"
#include "tests/evaluation/tool_main.h"

namespace mapweld::evaluation {
namespace {

namespace fs = std::filesystem;

std::vector<std::uint8_t> read(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) throw std::runtime_error("cannot read " + path.string());
  return {std::istreambuf_iterator<char>(file), {}};
}

struct Photograph {
  std::string name;
  AppearanceVector appearances;
};

std::vector<Photograph> load(const std::string& folder, const Vocabulary& vocabulary, int threads) {
  std::vector<Photograph> photographs;
  for (const std::string& name : photograph_names(folder)) photographs.push_back({name, {}});
  std::atomic<std::size_t> next{0};
  const auto work = [&] {
    for (std::size_t i = next++; i < photographs.size(); i = next++) {
      const Features features =
          extract_features(decode_grey(read(photographs_folder() / folder / photographs[i].name)));
      photographs[i].appearances = make_appearance_vector(features, vocabulary.quantise(features));
    }
  };
  std::vector<std::jthread> workers;
  for (int t = 1; t < threads; ++t) workers.emplace_back(work);
  work();
  return photographs;
}

using Pair = std::pair<std::size_t, std::size_t>;  // of photographs of a and b

std::set<Pair> joined_carefully(const fs::path& cache, const Place& place, const std::vector<Photograph>& a,
                                const std::vector<Photograph>& b) {
  std::map<std::string, std::size_t> in_a, in_b;
  for (std::size_t i = 0; i < a.size(); ++i) in_a[a[i].name] = i;
  for (std::size_t j = 0; j < b.size(); ++j) in_b[b[j].name] = j;
  std::set<Pair> joined;
  for (const CarefulPair& pair : read_careful_pairs(cache, place).value_or(std::vector<CarefulPair>{})) {
    joined.emplace(in_a.at(pair.a_name), in_b.at(pair.b_name));
  }
  return joined;
}

// How likely a pair that is joined carefully has more votes than one that is not (half for as many), of the pairs with
// ten equal words or more.
double area_under_curve(const std::vector<std::pair<std::uint32_t, bool>>& pairs) {
  std::map<std::uint32_t, std::array<double, 2>> by_votes;
  for (const auto& [votes, is_joined] : pairs) by_votes[votes][is_joined ? 1 : 0] += 1;
  double area = 0, others = 0, joined = 0;
  for (const auto& [votes, counts] : by_votes) {
    area += counts[1] * (others + counts[0] / 2);
    others += counts[0];
    joined += counts[1];
  }
  return area / (others * joined);
}

void report_candidates(const Place& place, const std::vector<Photograph>& a, const std::vector<Photograph>& b,
                       const std::set<Pair>& careful, const std::vector<VoteRule>& rules) {
  const auto verifier = make_verifier();
  std::map<Pair, bool> verdicts;
  for (const VoteRule rule : rules) {
    std::size_t candidates = 0, recalled = 0, edges = 0;
    std::vector<std::pair<std::uint32_t, bool>> of_words;
    for (std::size_t i = 0; i < a.size(); ++i) {
      for (std::size_t j = 0; j < b.size(); ++j) {
        const AppearanceVector &of_a = a[i].appearances, &of_b = b[j].appearances;
        const std::uint32_t votes = pair_votes(of_a, of_b, rule);
        const bool is_joined = careful.contains({i, j});
        if (pair_votes(of_a, of_b, VoteRule::kMin) >= default_min_votes(VoteRule::kMin)) {
          of_words.emplace_back(votes, is_joined);
        }
        if (votes < default_min_votes(rule)) continue;
        ++candidates;
        recalled += is_joined ? 1 : 0;
        const auto [verdict, is_new] = verdicts.try_emplace({i, j}, false);
        if (is_new) verdict->second = verifier->verify(of_a, of_b).accepted;
        edges += verdict->second ? 1 : 0;
      }
    }
    std::printf("| %s | %zu x %zu | %s | %zu | %.3f | %.3f | %zu |\n", place.name.c_str(), a.size(), b.size(),
                std::string(to_string(rule)).c_str(), candidates,
                static_cast<double>(recalled) / static_cast<double>(careful.size()), area_under_curve(of_words), edges);
    std::fflush(stdout);
  }
}

// Where each vertex of a map was taken, and what an answer is worth.
struct LocalizationTask {
  std::string name;
  std::vector<const Photograph*> of_map, queries;
  std::function<Truth(std::size_t query, std::size_t of_map)> truth;
};

void report_localization(const LocalizationTask& task, VoteRule rule) {
  MapParameters parameters;
  parameters.votes = rule;
  parameters.min_votes = default_min_votes(rule);
  const auto verifier = make_verifier();
  test::SceneMap map;
  std::vector<std::size_t> photograph_of;  // by vertex
  for (std::size_t i = 0; i < task.of_map.size(); ++i) {
    const MappingDecision decision = decide(task.of_map[i]->appearances, map, *verifier, parameters);
    if (decision.outcome == MappingDecision::Outcome::kIgnored) continue;
    std::vector<VertexId> neighbours;
    for (const LocalizationMatch& edge : decision.edges) neighbours.push_back(edge.vertex);
    map.add(decision.image, neighbours);
    photograph_of.push_back(i);
  }
  std::size_t right_by_votes = 0, right = 0, wrong = 0, unknown = 0, ambiguous = 0, candidates = 0;
  for (std::size_t q = 0; q < task.queries.size(); ++q) {
    const AppearanceVector& query = task.queries[q]->appearances;
    const Votes votes = vote(query, map.postings(), rule, parameters.min_votes);
    candidates += votes.candidates.size();
    const auto truth_of = [&](VertexId vertex) { return task.truth(q, photograph_of[to_index(vertex)]); };
    if (!votes.candidates.empty() && truth_of(votes.candidates.front().vertex) == Truth::kRight) ++right_by_votes;
    const Localization found = localize(query, map, *verifier, parameters);
    ambiguous += found.status == LocalizationStatus::kAmbiguous ? 1 : 0;
    if (found.status != LocalizationStatus::kLocalized) continue;
    const Truth truth = truth_of(found.matches.front().vertex);
    right += truth == Truth::kRight ? 1 : 0;
    wrong += truth == Truth::kWrong ? 1 : 0;
    unknown += truth == Truth::kUnknown ? 1 : 0;
  }
  const auto share = [&](std::size_t n) { return static_cast<double>(n) / static_cast<double>(task.queries.size()); };
  std::printf("| %s | %zu in %zu | %s | %.1f | %.3f | %.3f | %zu | %zu | %zu |\n", task.name.c_str(),
              task.queries.size(), map.size(), std::string(to_string(rule)).c_str(),
              static_cast<double>(candidates) / static_cast<double>(task.queries.size()), share(right_by_votes),
              share(right), unknown, wrong, ambiguous);
  std::fflush(stdout);
}

// The second folder's photographs in a map of the first's. Right: the place's files say so, or the careful matcher
// joins the query with the answer or with a photograph at most two before or after it.
LocalizationTask second_visit(const Place& place, const std::vector<Photograph>& a, const std::vector<Photograph>& b,
                              const std::set<Pair>& careful) {
  LocalizationTask task{place.name + ", b in a", {}, {}, {}};
  for (const Photograph& p : a) task.of_map.push_back(&p);
  for (const Photograph& p : b) task.queries.push_back(&p);
  task.truth = [&, truth = PlaceTruth(place)](std::size_t query, std::size_t of_map) {
    for (std::size_t near = of_map < 2 ? 0 : of_map - 2; near <= of_map + 2; ++near) {
      if (careful.contains({near, query})) return Truth::kRight;
    }
    return truth.of(a[of_map].name, b[query].name);
  };
  return task;
}

// Every tenth photograph of a folder in a map of the others. Right: at most three photographs apart in their order; in
// the museum, which has none, at most 8 m.
LocalizationTask held_out(const Place& place, bool of_a, const std::vector<Photograph>& photographs) {
  LocalizationTask task{place.name + (of_a ? ", a" : ", b") + ", every tenth", {}, {}, {}};
  std::vector<std::size_t> of_map, queries;
  for (std::size_t i = 0; i < photographs.size(); ++i) {
    const bool is_query = i % 10 == 5;
    (is_query ? queries : of_map).push_back(i);
    (is_query ? task.queries : task.of_map).push_back(&photographs[i]);
  }
  if (place.name == "museum-region") {
    std::map<std::string, std::pair<double, double>> at_m;
    std::ifstream file(photographs_folder() / place.name / "positions.csv");
    std::string map, name, x, y;
    std::getline(file, map);
    while (std::getline(file, map, ',') && std::getline(file, name, ',') && std::getline(file, x, ',') &&
           std::getline(file, y)) {
      if ((map == "a") == of_a) at_m[name] = {std::atof(x.c_str()), std::atof(y.c_str())};
    }
    task.truth = [at_m, &photographs, of_map, queries](std::size_t query, std::size_t answer) {
      const auto [qx, qy] = at_m.at(photographs[queries[query]].name);
      const auto [ax, ay] = at_m.at(photographs[of_map[answer]].name);
      return (qx - ax) * (qx - ax) + (qy - ay) * (qy - ay) <= 64 ? Truth::kRight : Truth::kWrong;
    };
    return task;
  }
  task.truth = [of_map, queries](std::size_t query, std::size_t answer) {
    const auto [low, high] = std::minmax(queries[query], of_map[answer]);
    return high - low <= 3 ? Truth::kRight : Truth::kUnknown;
  };
  return task;
}

int run(int argc, char** argv) {
  CLI::App app{"What votes find on the real places, rule by rule.", "vote_figures"};
  std::string careful_folder;
  std::vector<std::string> names, rule_names{"min", "signatures"};
  bool without_localization = false;
  int threads = 2;
  app.add_option("--careful", careful_folder, "where <place>.csv of careful_matcher are")
      ->required()
      ->check(CLI::ExistingDirectory);
  app.add_option("--places", names, "some of them only");
  app.add_option("--rules", rule_names)->check(CLI::IsMember({"min", "product", "signatures"}));
  app.add_flag("--candidates-only", without_localization);
  app.add_option("--threads", threads, "change no figure")->check(CLI::PositiveNumber);
  CLI11_PARSE(app, argc, argv);
  std::vector<VoteRule> rules;
  for (const std::string& name : rule_names) rules.push_back(*parse_vote_rule(name));
  const auto vocabulary = Vocabulary::deserialize(read(MAPWELD_SOURCE_DIR "/vocabularies/indoor-50k.mwv"));

  std::printf("| place | images | votes | candidates | recall | AUC | edges |\n|---|---|---|---|---|---|---|\n");
  std::vector<LocalizationTask> tasks;
  std::list<std::vector<Photograph>> loaded;
  std::list<std::set<Pair>> joined;
  for (const Place& place : places(false)) {
    if (!names.empty() && std::ranges::find(names, place.name) == names.end()) continue;
    const auto& a = loaded.emplace_back(load(place.a, *vocabulary, threads));
    const auto& b = loaded.emplace_back(load(place.b, *vocabulary, threads));
    if (a.empty() || b.empty()) continue;
    const auto& careful = joined.emplace_back(joined_carefully(careful_folder, place, a, b));
    report_candidates(place, a, b, careful, rules);
    tasks.push_back(second_visit(place, a, b, careful));
    tasks.push_back(held_out(place, true, a));
    tasks.push_back(held_out(place, false, b));
  }
  if (without_localization) return 0;
  std::printf(
      "\n| queries | in images | votes | candidates | first by votes | localized rightly | not known | wrongly | "
      "ambiguous |\n|---|---|---|---|---|---|---|---|---|\n");
  for (const LocalizationTask& task : tasks) {
    for (const VoteRule rule : rules) report_localization(task, rule);
  }
  return 0;
}

}  // namespace
}  // namespace mapweld::evaluation

int main(int argc, char** argv) {
  return mapweld::evaluation::tool_main("vote_figures", mapweld::evaluation::run, argc, argv);
}
