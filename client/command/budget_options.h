// A budget on the command line.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include <CLI/CLI.hpp>

#include "client/contract/budget.h"

namespace mapweld::command {

// "1.5s", "500ms", "2m", "2min", "1h" or a plain number of seconds; nothing when it is none of these, or not > 0.
std::optional<double> parse_duration_s(const std::string& text);

struct BudgetOptions {
  std::string time;
  std::optional<std::int64_t> verifications;
  std::optional<std::int64_t> edges;
  std::optional<double> fraction;
  bool certified = false;

  void add_to(CLI::App& command);
  // Nothing when no budget was given. Throws UsageError for one that no server would take.
  std::optional<contract::Budget> budget() const;
};

}  // namespace mapweld::command
