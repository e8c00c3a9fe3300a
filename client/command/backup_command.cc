// mapweld backup FILE
#include <chrono>
#include <memory>
#include <string>
#include <thread>

#include "client/command/context.h"
#include "client/command/exit_code.h"
#include "client/command/output_file.h"
#include "client/command/terminal.h"

namespace mapweld::command {
namespace {

struct BackupOptions {
  std::string file;
  bool keep = false;
};

int backup(const Context& context, const BackupOptions& options) {
  client::Client server = context.connect();
  OutputFile out(options.file);
  auto made = server.begin_backup();
  while (made->state == "running") {
    std::this_thread::sleep_for(std::chrono::milliseconds(200));
    made = server.backup(made->id);
  }
  if (made->state != "completed") {
    print("The backup failed: " + printable(made->error.value_or("the server does not say why")) + "\n");
    return kServerSaidNo;
  }
  server.backup_content(made->id, [&](std::string_view piece) { out.write(piece); });
  out.commit();
  if (!options.keep) server.delete_backup(made->id);
  if (context.json) {
    print_json(made.json);
  } else if (options.file != "-") {
    print("The whole server is in " + options.file + ", " +
          bytes_text(static_cast<std::uint64_t>(made->bytes.value_or(0))) + ", as it was at " +
          time_text(made->created_at) + ". Keys are not.\nMake a server of it: mapweld-server restore --data NEW " +
          options.file + "\n");
  }
  return kDone;
}

}  // namespace

void add_backup_command(CLI::App& app, Context& context) {
  const auto options = std::make_shared<BackupOptions>();
  CLI::App* command = app.add_subcommand("backup", "Copy everything that the server has into one file");
  command->add_option("FILE", options->file, "The file, or - for standard output")->required();
  command->add_flag("--keep", options->keep, "Leave the copy on the server too");
  command->callback([=, &context] { context.action = [=, &context] { return backup(context, *options); }; });
}

}  // namespace mapweld::command
