// Where pieces of work run that do not depend on each other. Core has no threads of its own; who drives a merge brings
// them.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>

namespace mapweld {

// Tasks that run beside the one thread that submits them.
class TaskLine {
 public:
  // Forgets the tasks that have not begun and waits for those that have.
  virtual ~TaskLine() = default;
  // Tasks begin in the order given. A task must not throw.
  virtual void submit(std::function<void()> task) = 0;
};

class Executor {
 public:
  virtual ~Executor() = default;
  // How many pieces can run at the same time; 1 or more.
  virtual std::size_t concurrency() const = 0;
  // Calls piece(0) .. piece(pieces - 1), in any order and on any thread, the caller's too, and returns when all have
  // returned. `piece` must not throw. Any thread may call it, a piece too.
  virtual void run(std::size_t pieces, const std::function<void(std::size_t)>& piece) const = 0;
  // A line whose tasks run on the other threads than the caller's. This must outlive it.
  virtual std::unique_ptr<TaskLine> open_line() const = 0;
};

// The same without an executor.
inline void run_pieces(const Executor* executor, std::size_t pieces, const std::function<void(std::size_t)>& piece) {
  if (executor != nullptr) return executor->run(pieces, piece);
  for (std::size_t i = 0; i < pieces; ++i) piece(i);
}

}  // namespace mapweld
