// Work that recurses deeper than a thread's usual stack reaches.
#pragma once

#include <cstddef>
#include <functional>

namespace mapweld {

// Runs `work` to its end on a stack of at least so many bytes (pages are taken as they are touched); what it throws is
// thrown here. Throws std::system_error when no such stack can be had; `work` has not begun then.
void run_on_stack(std::size_t bytes, const std::function<void()>& work);

}  // namespace mapweld
