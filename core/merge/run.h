// The anytime run loop, and the stop conditions that it knows.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string_view>
#include <vector>

#include "core/merge/merger.h"

namespace mapweld {

// Why a run ended before the merge was done; the words of http-api.md.
enum class StopReason : std::uint8_t { kSeconds, kVerifications, kEdges, kFractionOfMaximum, kPaused };
std::string_view to_string(StopReason reason);

// Asked before every step: a reason to stop now, or nothing. Must not change the merger.
using StopCondition = std::function<std::optional<StopReason>(const Merger&)>;

// Stops with exactly so many verifications (edges) made since the merge began; at once when there are as many already.
StopCondition stop_at_verifications(std::uint64_t verifications);
StopCondition stop_at_edges(std::uint64_t edges);
// Stops when `holds()`: a clock, a pause, a signal; core has none of its own.
StopCondition stop_when(std::function<bool()> holds, StopReason reason);
// The same for what only the merger can tell.
StopCondition stop_when_merger(std::function<bool(const Merger&)> holds, StopReason reason);
// The first of `conditions`, in their order, that holds.
StopCondition stop_at_first(std::vector<StopCondition> conditions);

// Called after every step. Must not change the merger.
using MergeObserver = std::function<void(const Merger&)>;

// Steps until the merge is done (nothing returned) or `stop` has a reason. Calling it again goes on where it stopped.
// Either may be empty: no condition, nobody watching.
std::optional<StopReason> run(Merger& merger, const StopCondition& stop, const MergeObserver& observer = {});

}  // namespace mapweld
