// Memory that is kept for when there is none.
#pragma once

namespace mapweld::server {

// While it lives, an operator new that finds no memory gets a piece of the reserve and tries again; when nothing is
// left it throws std::bad_alloc as ever. So what an event loop needs to go on (asio ends the process when it cannot
// begin to wait) is there although a request asked for too much. Several share one reserve; a new handler that stood
// before the first stands again after the last.
class MemoryReserve {
 public:
  MemoryReserve();
  ~MemoryReserve();
  MemoryReserve(const MemoryReserve&) = delete;

  // Takes what was given away from the memory that there is now, as far as there is any. Any thread.
  static void refill() noexcept;
};

}  // namespace mapweld::server
