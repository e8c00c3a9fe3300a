// The command `mapweld-server serve`.
#pragma once

namespace CLI {
class App;
}

namespace mapweld::server {

// Adds the subcommand; it runs when the command line is parsed. Throws CLI::RuntimeError with the exit code: 1 when the
// server could not start, 0 after it was asked to stop.
void add_serve_command(CLI::App& app);

// The hidden subcommand `decode-images` (server/decoding/decoder_process.h).
void add_decode_command(CLI::App& app);

}  // namespace mapweld::server
