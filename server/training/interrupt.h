// Ctrl-C as a question that a long task asks itself now and then.
#pragma once

namespace mapweld {

// While one lives, the first SIGINT or SIGTERM sets a flag instead of ending the process; the second ends it as usual.
// One at a time in a process.
class InterruptFlag {
 public:
  InterruptFlag();
  ~InterruptFlag();
  InterruptFlag(const InterruptFlag&) = delete;
  InterruptFlag& operator=(const InterruptFlag&) = delete;

  static bool raised();
};

}  // namespace mapweld
