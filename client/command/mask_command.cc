// mapweld mask set|show|clear
#include <cmath>
#include <memory>

#include "client/command/context.h"
#include "client/command/exit_code.h"
#include "client/command/output_file.h"
#include "client/command/terminal.h"
#include "client/image_folder.h"

namespace mapweld::command {
namespace {

struct MaskOptions {
  std::string map;
  std::string file;
};

std::string sentence(const contract::Map& map) {
  if (!map.mask) return "Map " + map.name + " has no mask: every pixel of its images is used.\n";
  const contract::MapMask& mask = *map.mask;
  return "Map " + map.name + " has a mask of " + std::to_string(mask.width_px) + "x" + std::to_string(mask.height_px) +
         " pixels, which uses " + std::to_string(std::lround(100 * mask.used_share)) + " % of an image.\n";
}

int set(const Context& context, const MaskOptions& options) {
  const std::string png = client::read_file(options.file);
  client::Client server = context.connect();
  server.set_mask(options.map, png);
  const auto map = server.map(options.map);
  if (context.json) {
    print_json(map.json);
  } else {
    print(sentence(*map) + "It counts for what is uploaded or localized from now on.\n");
  }
  return kDone;
}

int show(const Context& context, const MaskOptions& options) {
  client::Client server = context.connect();
  if (!options.file.empty()) {
    OutputFile out(options.file);
    out.write(server.mask(options.map));
    out.commit();
    return kDone;
  }
  const auto map = server.map(options.map);
  if (context.json) {
    print_json(map.json);
  } else {
    print(sentence(*map));
  }
  return kDone;
}

int clear(const Context& context, const MaskOptions& options) {
  context.connect().clear_mask(options.map);
  if (!context.json) print("Map " + options.map + " has no mask any more.\n");
  return kDone;
}

}  // namespace

void add_mask_command(CLI::App& app, Context& context) {
  const auto options = std::make_shared<MaskOptions>();
  CLI::App* mask = app.add_subcommand("mask", "Say which pixels of a map's images are used");
  mask->require_subcommand(1);

  CLI::App* give =
      mask->add_subcommand("set", "Use only what is white in a PNG; of any size, it is laid over each image");
  give->add_option("MAP", options->map)->required();
  give->add_option("FILE", options->file, "A PNG: white where images are used, black where they are not")->required();
  give->callback([=, &context] { context.action = [=, &context] { return set(context, *options); }; });

  CLI::App* tell = mask->add_subcommand("show", "Say what a map's mask is, or write it to a file");
  tell->add_option("MAP", options->map)->required();
  tell->add_option("--out", options->file, "Write the PNG here")->type_name("FILE");
  tell->callback([=, &context] { context.action = [=, &context] { return show(context, *options); }; });

  CLI::App* take = mask->add_subcommand("clear", "Use every pixel again");
  take->add_option("MAP", options->map)->required();
  take->callback([=, &context] { context.action = [=, &context] { return clear(context, *options); }; });
}

}  // namespace mapweld::command
