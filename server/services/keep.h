// What a use case is asked to do in its transaction with what came of it, just before it commits: what is stored there
// stands or falls with the effect. What it throws undoes the effect.
#pragma once

#include <functional>

#include "schema/store.h"

namespace mapweld::server {

// Empty: nothing is asked. Called once for each outcome; again only when the transaction before was rolled back.
template <typename Outcome>
using Keep = std::function<void(WriteTransaction& db, const Outcome& outcome)>;

}  // namespace mapweld::server
