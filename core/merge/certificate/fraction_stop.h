// What a merge has reached of what it can reach; and stopping there.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "core/merge/certificate/certificate.h"
#include "core/merge/merger.h"
#include "core/merge/run.h"

namespace mapweld {

// The candidates of a merge that have no verdict, with the chances of PassRate. Nothing while there are votes still to
// be counted.
std::optional<std::vector<OpenCandidate>> open_with_chances(const Merger& merger);

// The certificate of a merge as it stands; every verified edge counts, confirmed or not.
std::optional<Certificate> certify(const Merger& merger);

// The first number of verifications after this one at which the fraction is tested: a test costs as much as some
// hundred verifications. Fixed numbers, so that a merge stops at the same step however often it was interrupted.
std::uint64_t next_fraction_test(std::uint64_t verifications);
// Whether this is such a number. 0 is none.
bool is_fraction_test(std::uint64_t verifications);

// Stops when, at a test, the fraction is reached and no vertex outside of the largest component could still come to it:
// by the certificate, or by the estimate and likely joins. In (0, 1]. Whether it holds is a function of the merger's
// state alone: asked first, last, or only after a pause at that very state, it says the same, and of a merge that it
// has stopped it holds again, as it does for any lower fraction. One condition is good for one merge.
StopCondition stop_at_fraction(double fraction, bool certified);

}  // namespace mapweld
