// Where pieces of work run that do not depend on each other. Core has no threads of its own; who drives a merge brings
// them.
#pragma once

#include <cstddef>
#include <functional>

namespace mapweld {

class Executor {
 public:
  virtual ~Executor() = default;
  // How many pieces can run at the same time; 1 or more.
  virtual std::size_t concurrency() const = 0;
  // Calls piece(0) .. piece(pieces - 1), in any order and on any thread, the caller's too, and returns when all have
  // returned. `piece` must not throw. Any thread may call it.
  virtual void run(std::size_t pieces, const std::function<void(std::size_t)>& piece) const = 0;
};

}  // namespace mapweld
