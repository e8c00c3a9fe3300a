// Of the pairs that the careful matcher joins, how many we lose and where (docs/evaluation.md, "What a careful matcher
// joins"): the votes, then the verifier by its reasons.
//
//   matching_figures --cache FOLDER [--places museum-region ...] [--min-votes 3]
// Votes by signatures, as a merge counts them by default. FOLDER: what careful_matcher has found before. Pairs that the
// place's own files call wrong are counted as such, and nowhere else.
#include <algorithm>
#include <cstdio>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>

#include "core/geometry/epipolar_verifier.h"
#include "core/retrieval/voting.h"
#include "tests/core/geometry/photographs.h"
#include "tests/evaluation/careful_pairs.h"
#include "tests/evaluation/tool_main.h"

namespace mapweld::evaluation {
namespace {

// Images of either map that have an edge.
struct Joined {
  std::set<std::size_t> a, b;
  void add(std::size_t i, std::size_t j) {
    a.insert(i);
    b.insert(j);
  }
  std::size_t size() const { return a.size() + b.size(); }
};

struct Figures {
  std::size_t candidates = 0, verified = 0, wrong = 0;
  std::size_t careful = 0, without_votes = 0, found = 0;
  std::map<Reason, std::size_t> refused;  // of the careful pairs among the candidates
  Joined by_careful, by_verified;
};

Figures measure(const Place& place, const std::vector<CarefulPair>& careful, std::uint32_t min_votes) {
  const std::vector<std::string> a_names = photograph_names(place.a), b_names = photograph_names(place.b);
  const auto& a = test::photographs(place.a);
  const auto& b = test::photographs(place.b);
  std::set<std::pair<std::string, std::string>> is_careful;
  for (const CarefulPair& pair : careful) is_careful.emplace(pair.a_name, pair.b_name);
  const PlaceTruth truth(place);
  const EpipolarVerifier verifier;
  Figures figures;
  for (std::size_t i = 0; i < a.size(); ++i) {
    for (std::size_t j = 0; j < b.size(); ++j) {
      const bool is_wrong = truth.of(a_names[i], b_names[j]) == Truth::kWrong;
      const bool counts = !is_wrong && is_careful.contains({a_names[i], b_names[j]});
      if (counts) {
        ++figures.careful;
        figures.by_careful.add(i, j);
      }
      if (pair_votes(a[i].appearances, b[j].appearances, VoteRule::kSignatures) < min_votes) {
        figures.without_votes += counts ? 1 : 0;
        continue;
      }
      ++figures.candidates;
      const Verification v = verifier.verify(a[i].appearances, b[j].appearances);
      if (!v.accepted) {
        if (counts) ++figures.refused[v.reason];
        continue;
      }
      ++figures.verified;
      figures.wrong += is_wrong ? 1 : 0;
      figures.found += counts ? 1 : 0;
      if (!is_wrong) figures.by_verified.add(i, j);
    }
  }
  return figures;
}

double percent(std::size_t part, std::size_t whole) {
  return whole == 0 ? 100 : 100 * static_cast<double>(part) / static_cast<double>(whole);
}

void print(const Place& place, const Figures& f) {
  const auto refused = [&](Reason reason) {
    const auto found = f.refused.find(reason);
    return found == f.refused.end() ? std::size_t{0} : found->second;
  };
  std::printf(
      "| %s | %zu | %zu | %zu | %zu | %zu | %zu | %zu | %.0f %% | %zu, %zu | %zu, %zu | %.0f %% | %zu | %zu |\n",
      place.name.c_str(), f.careful, f.without_votes, refused(Reason::kTooFewFeatures), refused(Reason::kTooFewInliers),
      refused(Reason::kNotSignificant), refused(Reason::kInconsistent), f.found, percent(f.found, f.careful),
      f.by_careful.a.size(), f.by_careful.b.size(), f.by_verified.a.size(), f.by_verified.b.size(),
      percent(f.by_verified.size(), f.by_careful.size()), f.candidates, f.wrong);
  std::fflush(stdout);
}

int run(int argc, char** argv) {
  CLI::App app{"Of the careful matcher's pairs, how many are lost where.", "matching_figures"};
  std::string cache;
  std::vector<std::string> names;
  bool between_storeys = false;
  std::uint32_t min_votes = default_min_votes(VoteRule::kSignatures);
  app.add_option("--cache", cache, "where <place>.csv are")->required()->check(CLI::ExistingDirectory);
  app.add_option("--places", names, "some of them only");
  app.add_flag("--between-storeys", between_storeys, "also pairs of look-alike storeys");
  app.add_option("--min-votes", min_votes, "a pair is a candidate with so many votes");
  CLI11_PARSE(app, argc, argv);
  std::printf(
      "| place | careful | lost: votes | too few features | too few inliers | not significant | inconsistent | "
      "verified "
      "| of careful | joined by careful | by verified | %% | candidates | known wrong |\n"
      "|---|---|---|---|---|---|---|---|---|---|---|---|---|---|\n");
  for (const Place& place : places(between_storeys)) {
    if (!names.empty() && std::ranges::find(names, place.name) == names.end()) continue;
    const auto careful = read_careful_pairs(cache, place);
    if (!careful || test::photographs(place.a).empty() || test::photographs(place.b).empty()) continue;
    print(place, measure(place, *careful, min_votes));
  }
  return 0;
}

}  // namespace
}  // namespace mapweld::evaluation

int main(int argc, char** argv) {
  return mapweld::evaluation::tool_main("matching_figures", mapweld::evaluation::run, argc, argv);
}
