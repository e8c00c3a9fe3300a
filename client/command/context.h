// What every subcommand is given, and how it hands back what is to be done.
#pragma once

#include <functional>
#include <stdexcept>
#include <string>

#include <CLI/CLI.hpp>

#include "client/client.h"

namespace mapweld::command {

// A mistake on the command line or in a local file that only shows when the command runs.
class UsageError : public std::runtime_error {
  using std::runtime_error::runtime_error;
};

struct Context {
  std::string server = "http://127.0.0.1:8080";  // --server, MAPWELD_SERVER
  std::string key;                               // --key, MAPWELD_KEY
  bool json = false;                             // --json: what the server said, on standard output
  std::function<int()> action;                   // set by the subcommand that was chosen; returns an ExitCode

  client::Client connect() const { return client::Client(server, {.key = key}); }
};

// Each adds its subcommand; options live as long as `app`.
void add_map_command(CLI::App& app, Context& context);
void add_images_command(CLI::App& app, Context& context);
void add_mask_command(CLI::App& app, Context& context);
void add_upload_command(CLI::App& app, Context& context);
void add_localize_command(CLI::App& app, Context& context);
void add_merge_command(CLI::App& app, Context& context);
void add_merges_command(CLI::App& app, Context& context);
void add_explain_command(CLI::App& app, Context& context);
void add_graph_command(CLI::App& app, Context& context);
void add_backup_command(CLI::App& app, Context& context);
void add_server_commands(CLI::App& app, Context& context);  // quality, vocabularies, health

}  // namespace mapweld::command
