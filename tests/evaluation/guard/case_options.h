// What the tools that go through the guard's cases are asked.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "tests/evaluation/guard/guard_cases.h"

namespace mapweld::evaluation {

struct CaseOptions {
  std::string cache;  // folder of made merges
  std::vector<std::string> names, scenarios;
  std::vector<std::uint64_t> seeds;
  int threads = 2;  // for making merges; change no figure

  void add_to(CLI::App& app) {
    app.add_option("--cache", cache, "where made merges are kept")->required()->check(CLI::ExistingDirectory);
    app.add_option("--cases", names, "some cases or groups of them only");
    app.add_option("--scenarios", scenarios, "some of them only, rendered");
    app.add_option("--seeds", seeds, "buildings and drives: rendered scenarios instead of photographs");
    app.add_option("--threads", threads, "for making merges; change no figure")->check(CLI::PositiveNumber);
  }
  std::vector<GuardCase> cases() const { return chosen_cases(names, scenarios, seeds); }
};

}  // namespace mapweld::evaluation
