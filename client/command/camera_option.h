// Cameras and poses that are named on the command line.
#pragma once

#include <stdexcept>

#include "client/command/context.h"
#include "client/contract/problem.h"

namespace mapweld::command {

// What `read` (client/pose_file.h) gives; UsageError for what it refuses.
template <class Read>
auto read_option(const Read& read) {
  try {
    return read();
  } catch (const std::invalid_argument& error) {
    throw UsageError(error.what());
  } catch (const contract::ContractError& error) {
    throw UsageError(error.what());
  }
}

}  // namespace mapweld::command
