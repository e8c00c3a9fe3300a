// Following a merge: a panel on a terminal, lines elsewhere, JSON lines for programs, or nothing until it rests.
#pragma once

#include <cstdint>
#include <string>

#include "client/client.h"

namespace mapweld::command {

enum class WatchStyle : std::uint8_t {
  kPeople,  // a panel that is redrawn on a terminal, else a line when something has happened
  kJson,    // the server's answer, a line for every change
  kSilent,  // nothing
};

// Asks for merge `id` until it is neither queued nor running, or Ctrl-C is pressed, which leaves the merge alone. Rides
// out a server that is restarted: connections may fail for half a minute.
// Returns an ExitCode: kDone, kMergeNotDone for failed and cancelled ones, kInterrupted.
int watch(client::Client& server, std::int64_t id, WatchStyle style);

// The merge in two lines: "Merge 1 is complete after 1.50 s: 247 edges between the maps.", and what it is now.
std::string outcome_text(const contract::Merge& merge);

// "lab-a + lab-b -> lab"
std::string members_text(const contract::Merge& merge);

}  // namespace mapweld::command
