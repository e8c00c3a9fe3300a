#include "client/command/budget_options.h"

#include <charconv>
#include <cmath>

#include "client/command/context.h"

namespace mapweld::command {

std::optional<double> parse_duration_s(const std::string& text) {
  double number = 0;
  const char* end = text.data() + text.size();
  const auto [rest, error] = std::from_chars(text.data(), end, number, std::chars_format::fixed);
  if (error != std::errc() || !std::isfinite(number) || number <= 0) return std::nullopt;
  const std::string unit(rest, end);
  if (unit == "ms") return number / 1000;
  if (unit.empty() || unit == "s") return number;
  if (unit == "m" || unit == "min") return number * 60;
  if (unit == "h") return number * 3600;
  return std::nullopt;
}

void BudgetOptions::add_to(CLI::App& command) {
  command.add_option("--budget", time, "Stop after so much time: 1.5s, 500ms, 2m, 1h")
      ->type_name("TIME")
      ->group("Budget")
      ->check([](const std::string& text) {
        return parse_duration_s(text) ? "" : "\"" + text + "\" is not a time above zero: 1.5s, 500ms, 2m, 1h";
      });
  command.add_option("--budget-verifications", verifications, "Stop after exactly so many verified candidates")
      ->type_name("N")
      ->group("Budget");
  command.add_option("--budget-edges", edges, "Stop after so many edges between the maps")
      ->type_name("N")
      ->group("Budget");
  auto* fraction_option =
      command
          .add_option("--budget-fraction", fraction, "Stop at this share of the algebraic connectivity within reach")
          ->type_name("F")
          ->group("Budget");
  command.add_flag("--certified", certified, "Judge that share by the certificate, not by the estimate")
      ->needs(fraction_option)
      ->group("Budget");
}

std::optional<contract::Budget> BudgetOptions::budget() const {
  if (time.empty() && !verifications && !edges && !fraction) return std::nullopt;
  contract::Budget budget;
  if (!time.empty()) budget.seconds = parse_duration_s(time);
  budget.verifications = verifications;
  budget.edges = edges;
  budget.fraction_of_maximum = fraction;
  if (certified) budget.certified = true;
  try {
    contract::check(budget);
  } catch (const contract::ContractError& error) {
    throw UsageError(error.what());
  }
  return budget;
}

}  // namespace mapweld::command
