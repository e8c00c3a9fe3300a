// The `mapweld` command. Each subcommand has a file of its own; errors become messages and exit codes here.
#include <csignal>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <system_error>

#include <CLI/CLI.hpp>

#include "client/command/context.h"
#include "client/command/exit_code.h"
#include "client/command/terminal.h"

namespace {

using namespace mapweld;  // NOLINT(google-build-using-namespace)
using command::Context;

void complain(const std::string& text) { std::fprintf(stderr, "mapweld: %s\n", command::printable(text).c_str()); }

void complain(const client::ServerProblem& error, bool has_key) {
  std::string about = error.code().empty() ? "" : error.code() + ", ";
  about += "HTTP " + std::to_string(error.status());
  if (!error.request_id().empty()) about += ", request " + error.request_id();
  complain(error.detail() + " (" + about + ")");
  if (error.status() == 401) {
    complain(has_key ? "The server does not take the key that was given (--key, MAPWELD_KEY)."
                     : "Give a key: MAPWELD_KEY=... in the environment, or --key.");
  }
}

int run(const Context& context) {
  try {
    return context.action();
  } catch (const client::ServerProblem& error) {
    if (context.json) command::print_json(error.problem());
    complain(error, !context.key.empty());
    return command::kServerSaidNo;
  } catch (const client::UnexpectedAnswer& error) {
    complain(std::string(error.what()) + " Is " + context.server + " a mapweld-server?");
    return command::kServerSaidNo;
  } catch (const client::ConnectionError& error) {
    complain(error.what());
    return command::kNoConnection;
  } catch (const command::UsageError& error) {
    complain(error.what());
    return command::kUsage;
  } catch (const std::invalid_argument& error) {
    complain(error.what());
    return command::kUsage;
  } catch (const std::filesystem::filesystem_error& error) {
    complain(error.path1().string() + ": " + error.code().message());
    return command::kUsage;
  } catch (const std::system_error& error) {
    complain(error.what());
    return command::kUsage;
  }
}

}  // namespace

int main(int argc, char** argv) {
  Context context;
  CLI::App app("Builds appearance-based maps on a Mapweld server, merges them and finds places in them.", "mapweld");
  app.set_version_flag("--version", "mapweld " MAPWELD_VERSION);
  app.add_option("--server", context.server, "The server's address")
      ->envname("MAPWELD_SERVER")
      ->type_name("URL")
      ->capture_default_str();
  app.add_option("--key", context.key,
                 "The key that the server asks for; better in the variable than where ps shows it")
      ->envname("MAPWELD_KEY")
      ->type_name("KEY");
  app.add_flag("--json", context.json, "Print what the server answered, as JSON");
  app.require_subcommand(1);
  app.fallthrough();
  app.footer(std::string("mapweld COMMAND --help says more about each.\n\n") + command::kExitCodeHelp);

  command::add_map_command(app, context);
  command::add_mask_command(app, context);
  command::add_upload_command(app, context);
  command::add_localize_command(app, context);
  command::add_merge_command(app, context);
  command::add_merges_command(app, context);
  command::add_explain_command(app, context);
  command::add_graph_command(app, context);
  command::add_images_command(app, context);
  command::add_backup_command(app, context);
  command::add_server_commands(app, context);

  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? command::kDone : command::kUsage;
  }
  try {
    return run(context);
  } catch (const std::exception& error) {
    complain(error.what());
    return command::kServerSaidNo;
  }
}
