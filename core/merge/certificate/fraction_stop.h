// Stopping a merge where it has reached enough of what it can reach.
#pragma once

#include <cstdint>

#include "core/merge/certificate/outlook.h"
#include "core/merge/run.h"

namespace mapweld {

// The first number of verifications after this one at which the fraction of a merge of so many candidates is tested. A
// test costs in proportion to the candidates, so that there are some two hundred and fifty at most, and fewer later
// on. Fixed numbers, so that a merge stops at the same step however often it was interrupted.
std::uint64_t next_fraction_test(std::uint64_t verifications, std::uint64_t candidates);
// Whether this is such a number. 0 is none.
bool is_fraction_test(std::uint64_t verifications, std::uint64_t candidates);

// Stops when, at a test, the fraction is reached: by the certificate, and no vertex outside of the largest component
// could still come to it; or by the estimate, of lambda_2 and of the largest component's vertices both. In (0, 1].
// `judge`: of the edges; none: all are confirmed. Whether it holds is a function of the merger's state alone: asked
// first, last, or only after a pause at that very state, it says the same, and of a merge that it has stopped it holds
// again, as it does for any lower fraction. One condition is good for one merge.
StopCondition stop_at_fraction(double fraction, bool certified, EdgeJudge judge = {});

}  // namespace mapweld
