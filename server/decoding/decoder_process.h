// A process that decodes images and can do nothing else.
#pragma once

#include <cstddef>

namespace mapweld::server {

// What `mapweld-server decode-images` does, started by DecoderPool with its socket and shared memory as descriptors 3
// and 4 (decoder_protocol.h): enters the sandbox and decodes until the socket closes. Returns the exit code.
int run_decoder_process();

// From here on this process may read and write descriptors that it has, ask for memory and exit; any other system call
// ends it (seccomp). It can open nothing, start nothing, and hold at most `max_memory_bytes`. Throws std::system_error
// where the kernel refuses. Under a sanitizer, which needs more than that, only the memory of core dumps is forbidden.
void enter_sandbox(std::size_t max_memory_bytes);

}  // namespace mapweld::server
