// Which pairs of photographs a careful matcher joins (docs/evaluation.md, "What is right and never found").
//
//   careful_matcher --cache FOLDER                       every place of MAPWELD_PHOTOS; FOLDER/<place>.csv
//   careful_matcher --cache FOLDER --places museum-region corridor-two-laps
//   careful_matcher --cache FOLDER --between-storeys     also pairs of look-alike storeys, which share nothing
// What a file is there for already is not matched again.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "tests/evaluation/careful_pairs.h"
#include "tests/evaluation/tool_main.h"

namespace mapweld::evaluation {
namespace {

void report(const Place& place, const std::vector<CarefulPair>& pairs, double elapsed_s) {
  const PlaceTruth truth(place);
  std::size_t right = 0, wrong = 0;
  for (const CarefulPair& pair : pairs) {
    const Truth known = truth.of(pair.a_name, pair.b_name);
    right += known == Truth::kRight ? 1 : 0;
    wrong += known == Truth::kWrong ? 1 : 0;
  }
  std::printf("| %s | %zu + %zu | %zu | %zu | %zu | %.0f |\n", place.name.c_str(), photograph_names(place.a).size(),
              photograph_names(place.b).size(), pairs.size(), right, wrong, elapsed_s);
  std::fflush(stdout);
}

int run(int argc, char** argv) {
  CLI::App app{"Which pairs of photographs a careful matcher joins.", "careful_matcher"};
  CarefulMatcherOptions options;
  std::string cache;
  std::vector<std::string> names;
  bool between_storeys = false;
  int threads = 2;
  app.add_option("--cache", cache, "where <place>.csv are, and where new ones go")
      ->required()
      ->check(CLI::ExistingDirectory);
  app.add_option("--places", names, "some of them only");
  app.add_flag("--between-storeys", between_storeys, "also pairs of look-alike storeys");
  app.add_option("--threads", threads, "change no figure")->check(CLI::PositiveNumber);
  app.add_option("--max-distance-px", options.max_distance_px, "from the epipolar line");
  CLI11_PARSE(app, argc, argv);
  std::printf("| place | images | joined | known right | known wrong | s |\n|---|---|---|---|---|---|\n");
  for (const Place& place : places(between_storeys)) {
    if (!names.empty() && std::ranges::find(names, place.name) == names.end()) continue;
    if (photograph_names(place.a).empty() || photograph_names(place.b).empty()) continue;
    const auto start = std::chrono::steady_clock::now();
    auto pairs = read_careful_pairs(cache, place);
    if (!pairs) {
      pairs = match_carefully(place, options, threads);
      write_careful_pairs(cache, place, *pairs);
    }
    report(place, *pairs, std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
  }
  return 0;
}

}  // namespace
}  // namespace mapweld::evaluation

int main(int argc, char** argv) {
  return mapweld::evaluation::tool_main("careful_matcher", mapweld::evaluation::run, argc, argv);
}
