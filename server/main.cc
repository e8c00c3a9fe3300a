// mapweld-server: serve, key, train, check, backup, restore, purge, evaluate.
#include <CLI/CLI.hpp>

#include "server/commands/backup.h"
#include "server/commands/check.h"
#include "server/commands/evaluate.h"
#include "server/commands/key.h"
#include "server/commands/purge.h"
#include "server/commands/serve.h"
#include "server/training/train.h"
#include "server/version.h"

int main(int argc, char** argv) {
  CLI::App app("A map database server for appearance-based maps", "mapweld-server");
  app.set_version_flag("--version", std::string(mapweld::server::version()));
  app.require_subcommand(1);
  mapweld::server::add_serve_command(app);
  mapweld::server::add_decode_command(app);
  mapweld::server::add_key_command(app);
  mapweld::add_train_command(app);
  mapweld::server::add_check_command(app);
  mapweld::server::add_backup_commands(app);
  mapweld::server::add_purge_command(app);
  mapweld::server::add_evaluate_command(app);
  CLI11_PARSE(app, argc, argv);
  return 0;
}
