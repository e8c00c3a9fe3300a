// mapweld images delete|restore
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "client/command/context.h"
#include "client/command/exit_code.h"
#include "client/command/terminal.h"

namespace mapweld::command {
namespace {

struct ImagesOptions {
  std::string map;
  std::vector<std::int64_t> vertices;
  std::vector<std::string> names;
  std::optional<std::int64_t> from;
  std::optional<std::int64_t> to;
  bool pixels_only = false;
};

int remove(const Context& context, const ImagesOptions& options) {
  if (options.from.has_value() != options.to.has_value()) throw UsageError("--from and --to go together.");
  if (options.vertices.empty() && options.names.empty() && !options.from) {
    throw UsageError("Say which images: numbers of vertices, --name, or --from and --to.");
  }
  client::Client server = context.connect();
  std::int64_t deleted = 0;
  for (const std::int64_t vertex : options.vertices) {
    if (options.pixels_only) {
      server.delete_vertex_image(options.map, vertex);
      ++deleted;
    } else {
      deleted += server.delete_vertex(options.map, vertex)->deleted;
    }
  }
  for (const std::string& name : options.names) deleted += server.delete_named(options.map, name)->deleted;
  if (options.from) deleted += server.delete_vertices(options.map, *options.from, *options.to)->deleted;
  if (context.json) {
    print_json(contract::Json(contract::Deleted{.deleted = deleted}));
  } else if (options.pixels_only) {
    print("The pixels of " + count_text(deleted, "image") + " of " + options.map + " are gone.\n");
  } else {
    print(count_text(deleted, "image") + " of " + options.map +
          (deleted == 1 ? " is deleted. It comes" : " are deleted. They come") + " back with: mapweld images restore " +
          options.map + " VERTEX...\n");
  }
  return kDone;
}

int restore(const Context& context, const ImagesOptions& options) {
  client::Client server = context.connect();
  for (const std::int64_t vertex : options.vertices) {
    const auto restored = server.restore_vertex(options.map, vertex);
    if (context.json) {
      print_json(restored.json);
    } else {
      print("Vertex " + std::to_string(vertex) + " of " + options.map + " is back: " + printable(restored->name) +
            ".\n");
    }
  }
  return kDone;
}

}  // namespace

void add_images_command(CLI::App& app, Context& context) {
  const auto options = std::make_shared<ImagesOptions>();
  CLI::App* images = app.add_subcommand("images", "Delete images of a map, and bring them back");
  images->require_subcommand(1);

  CLI::App* gone = images->add_subcommand("delete", "Delete images: they show nowhere until they are restored");
  gone->add_option("MAP", options->map)->required();
  gone->add_option("VERTEX", options->vertices, "Numbers of vertices");
  CLI::Option* name = gone->add_option("--name", options->names, "Names of images");
  CLI::Option* from = gone->add_option("--from", options->from, "The first vertex of a range");
  gone->add_option("--to", options->to, "The last one of it");
  gone->add_flag("--pixels-only", options->pixels_only, "Take the images' bytes away, for good, and leave the vertices")
      ->excludes(name)
      ->excludes(from);
  gone->callback([=, &context] { context.action = [=, &context] { return remove(context, *options); }; });

  CLI::App* back = images->add_subcommand("restore", "Bring deleted images back, unless they were purged");
  back->add_option("MAP", options->map)->required();
  back->add_option("VERTEX", options->vertices, "Numbers of vertices")->required();
  back->callback([=, &context] { context.action = [=, &context] { return restore(context, *options); }; });
}

}  // namespace mapweld::command
