#include "core/merge/run.h"

#include <utility>

namespace mapweld {

std::string_view to_string(StopReason reason) {
  switch (reason) {
    case StopReason::kSeconds:
      return "seconds";
    case StopReason::kVerifications:
      return "verifications";
    case StopReason::kEdges:
      return "edges";
    case StopReason::kFractionOfMaximum:
      return "fraction_of_maximum";
    case StopReason::kPaused:
      return "paused";
  }
  return "";
}

StopCondition stop_at_verifications(std::uint64_t verifications) {
  return stop_when_merger([verifications](const Merger& m) { return m.state().verifications >= verifications; },
                          StopReason::kVerifications);
}

StopCondition stop_at_edges(std::uint64_t edges) {
  return stop_when_merger([edges](const Merger& m) { return m.state().edges.size() >= edges; }, StopReason::kEdges);
}

StopCondition stop_when(std::function<bool()> holds, StopReason reason) {
  return stop_when_merger([holds = std::move(holds)](const Merger&) { return holds(); }, reason);
}

StopCondition stop_when_merger(std::function<bool(const Merger&)> holds, StopReason reason) {
  return [holds = std::move(holds), reason](const Merger& merger) -> std::optional<StopReason> {
    if (holds(merger)) return reason;
    return std::nullopt;
  };
}

StopCondition stop_at_first(std::vector<StopCondition> conditions) {
  return [conditions = std::move(conditions)](const Merger& merger) -> std::optional<StopReason> {
    for (const StopCondition& condition : conditions) {
      if (const auto reason = condition(merger)) return reason;
    }
    return std::nullopt;
  };
}

std::optional<StopReason> run(Merger& merger, const StopCondition& stop, const MergeObserver& observer) {
  while (!merger.done()) {
    if (stop) {
      if (const auto reason = stop(merger)) return reason;
    }
    merger.step();
    if (observer) observer(merger);
  }
  return std::nullopt;
}

}  // namespace mapweld
