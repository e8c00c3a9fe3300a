#include "client/contract/budget.h"

#include <cmath>
#include <string>

namespace mapweld::contract {
namespace {

void check_positive(const std::optional<double>& limit, const std::string& name) {
  if (limit && !(std::isfinite(*limit) && *limit > 0)) {
    throw ContractError("invalid_budget", "\"budget." + name + "\" must be greater than 0.");
  }
}

}  // namespace

void check(const Budget& budget) {
  check_positive(budget.seconds, "seconds");
  check_positive(budget.verifications, "verifications");
  check_positive(budget.edges, "edges");
  check_positive(budget.fraction_of_maximum, "fraction_of_maximum");
  if (budget.fraction_of_maximum && *budget.fraction_of_maximum > 1) {
    throw ContractError("invalid_budget", "\"budget.fraction_of_maximum\" must be at most 1.");
  }
}

}  // namespace mapweld::contract
