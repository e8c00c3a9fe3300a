// mapweld map create|list|show|change|delete|export|import
#include <cmath>
#include <map>
#include <memory>

#include "client/command/camera_option.h"
#include "client/command/context.h"
#include "client/command/exit_code.h"
#include "client/command/output_file.h"
#include "client/command/terminal.h"
#include "client/pose_file.h"

namespace mapweld::command {
namespace {

struct MapOptions {
  contract::CreateMap create;
  contract::MapParameters parameters;
  std::vector<std::string> labels;  // KEY=TEXT
  std::string name;
  std::string idempotency_key;
  std::string camera;
};

struct CopyOptions {
  std::string map;
  std::string file;
  std::optional<std::string> name;
  bool without_images = false;
};

std::string percent_text(double share) { return std::to_string(std::lround(100 * share)) + " %"; }

std::string describe(const contract::Map& map) {
  std::vector<std::pair<std::string, std::string>> lines = {
      {"name", map.name},
      {"kind", map.kind},
      {"vocabulary", map.vocabulary},
      {"vertices", std::to_string(map.vertices)},
      {"edges", edge_counts_text(map.edge_counts)},
      {"ignored", count_text(map.ignored, "image") + " too similar or identical to others"},
  };
  if (map.merge) {
    std::string members;
    for (const auto& member : map.members) {
      members +=
          (members.empty() ? "" : ", ") + member.map + " (" + count_text(member.watermark, "vertex", "vertices") + ")";
    }
    lines.emplace_back("members", members);
    lines.emplace_back("merge", std::to_string(*map.merge));
  }
  std::string parameters;
  const contract::Json all = map.parameters;
  for (const auto& [key, value] : all.items()) {
    parameters +=
        (parameters.empty() ? "" : ", ") + key + " " + (value.is_string() ? value.get<std::string>() : value.dump());
  }
  lines.emplace_back("parameters", parameters);
  if (map.mask) {
    lines.emplace_back("mask", std::to_string(map.mask->width_px) + "x" + std::to_string(map.mask->height_px) + ", " +
                                   percent_text(map.mask->used_share) + " of an image used");
  }
  if (map.camera) {
    const contract::Json focal = {map.camera->fx_px, map.camera->fy_px, map.camera->cx_px, map.camera->cy_px};
    lines.emplace_back("camera", map.camera->model + " " + focal.dump());
  }
  if (map.static_share > 0) {
    lines.emplace_back("static", percent_text(map.static_share) + " of an image, the same in all of them, is left out");
  }
  std::string labels;
  for (const auto& [key, text] : map.labels) labels += (labels.empty() ? "" : ", ") + printable(key + "=" + text);
  if (!labels.empty()) lines.emplace_back("labels", labels);
  lines.emplace_back("created", time_text(map.created_at));
  lines.emplace_back("uuid", map.uuid);
  return facts(lines);
}

std::map<std::string, std::string> labels_of(const std::vector<std::string>& texts) {
  std::map<std::string, std::string> labels;
  for (const std::string& label : texts) {
    const auto equals = label.find('=');
    if (equals == std::string::npos || equals == 0) throw UsageError("A label is KEY=TEXT, not \"" + label + "\".");
    labels[label.substr(0, equals)] = label.substr(equals + 1);
  }
  return labels;
}

int create(const Context& context, const MapOptions& options) {
  contract::CreateMap request = options.create;
  if (options.parameters != contract::MapParameters{}) request.parameters = options.parameters;
  if (!options.labels.empty()) request.labels = labels_of(options.labels);
  const auto map = context.connect().create_map(request, options.idempotency_key);
  if (context.json) {
    print_json(map.json);
  } else {
    print("Map " + map->name + " is there, empty, with the words of " + map->vocabulary + ".\n");
  }
  return kDone;
}

int change(const Context& context, const MapOptions& options) {
  contract::ChangeMap change;
  if (!options.create.name.empty()) change.name = options.create.name;
  if (options.parameters != contract::MapParameters{}) change.parameters = options.parameters;
  if (!options.labels.empty()) change.labels = labels_of(options.labels);
  if (options.camera == "none") {
    change.camera.emplace();
  } else if (!options.camera.empty()) {
    change.camera = read_option([&] { return client::read_camera(options.camera); });
  }
  if (change == contract::ChangeMap{}) throw UsageError("Say what is to change.");
  const auto map = context.connect().change_map(options.name, change);
  if (context.json) {
    print_json(map.json);
  } else {
    print(describe(*map));
  }
  return kDone;
}

int list(const Context& context) {
  const auto maps = context.connect().maps();
  if (context.json) {
    print_json(maps.json);
  } else if (maps->empty()) {
    print("There is no map yet. Make one: mapweld map create NAME\n");
  } else {
    Table table({"NAME", "KIND", "VERTICES", "CONFIRMED", "VERIFIED", "IGNORED", "VOCABULARY", "CREATED"},
                {2, 3, 4, 5});
    for (const contract::Map& map : *maps) {
      table.add({map.name, map.kind, std::to_string(map.vertices), std::to_string(map.edge_counts.confirmed),
                 std::to_string(map.edge_counts.verified), std::to_string(map.ignored), map.vocabulary,
                 time_text(map.created_at)});
    }
    print(table.text());
  }
  return kDone;
}

int show(const Context& context, const std::string& name) {
  const auto map = context.connect().map(name);
  if (context.json) {
    print_json(map.json);
  } else {
    print(describe(*map));
  }
  return kDone;
}

int remove(const Context& context, const std::string& name) {
  context.connect().delete_map(name);
  if (!context.json) print("Map " + name + " is gone.\n");
  return kDone;
}

int export_map(const Context& context, const CopyOptions& options) {
  OutputFile out(options.file);
  std::uint64_t bytes = 0;
  context.connect().export_map(options.map, !options.without_images, [&](std::string_view piece) {
    bytes += piece.size();
    out.write(piece);
  });
  out.commit();
  if (!context.json && options.file != "-") {
    print("Map " + options.map + " is in " + options.file + ", " + bytes_text(bytes) + ".\n");
  }
  return kDone;
}

int import_map(const Context& context, const CopyOptions& options) {
  const auto map = context.connect().import_map(options.file, options.name);
  if (context.json) {
    print_json(map.json);
  } else {
    print("Map " + map->name + " is there: " + count_text(map->vertices, "vertex", "vertices") + ", " +
          count_text(map->edges, "edge") + ", with the words of " + map->vocabulary + ".\n");
  }
  return kDone;
}

}  // namespace

void add_map_command(CLI::App& app, Context& context) {
  const auto options = std::make_shared<MapOptions>();
  CLI::App* map = app.add_subcommand("map", "Make, list, show, change, delete and copy maps");
  map->require_subcommand(1);

  CLI::App* make = map->add_subcommand("create", "Make an empty map");
  make->add_option("NAME", options->create.name, "Letters, digits, dots, underscores and hyphens")->required();
  make->add_option("--idempotency-key", options->idempotency_key,
                   "Any text of yours: sent again with the same one, it is made once, and answered as before");
  make->add_option("--vocabulary", options->create.vocabulary, "The words to use (default: the server's)");
  make->add_option("--max-features", options->parameters.max_features, "Strongest features kept of an image");
  make->add_option("--min-votes", options->parameters.min_votes,
                   "Fewest votes of a candidate (default: 3 by signatures, 10 by words)");
  make->add_option("--min-inliers", options->parameters.min_inliers, "Fewest verified matches of an edge");
  make->add_option("--max-inliers", options->parameters.max_inliers, "An image with more is ignored as too similar");
  make->add_option("--verify-top", options->parameters.verify_top, "Best candidates that are verified");
  make->add_option("--votes", options->parameters.votes,
                   "What votes: equal words, or those whose signatures agree (default)")
      ->check(CLI::IsMember({"min", "product", "signatures"}));
  make->add_option("--store-images", options->parameters.store_images, "Whether pixels are kept")
      ->check(CLI::IsMember({"full", "none"}));
  make->add_option("--label", options->labels, "KEY=TEXT, any number of them")->type_name("KEY=TEXT");
  make->callback([=, &context] { context.action = [=, &context] { return create(context, *options); }; });

  CLI::App* all = map->add_subcommand("list", "List the maps");
  all->callback([&context] { context.action = [&context] { return list(context); }; });

  CLI::App* one = map->add_subcommand("show", "Show one map");
  one->add_option("NAME", options->name)->required();
  one->callback([=, &context] { context.action = [=, &context] { return show(context, options->name); }; });

  CLI::App* other = map->add_subcommand("change", "Give a map another name, other labels or other parameters");
  other->add_option("NAME", options->name)->required();
  other->add_option("--name", options->create.name, "The new name");
  other->add_option("--label", options->labels, "KEY=TEXT; the labels are then these alone")->type_name("KEY=TEXT");
  other->add_option("--max-inliers", options->parameters.max_inliers, "An image with more is ignored as too similar");
  other->add_option("--verify-top", options->parameters.verify_top, "Best candidates that are verified");
  other->add_option("--store-images", options->parameters.store_images, "Whether pixels are kept")
      ->check(CLI::IsMember({"full", "none"}));
  other->add_option("--camera", options->camera, "Of images that name none, as for upload; none takes it away");
  other->callback([=, &context] { context.action = [=, &context] { return change(context, *options); }; });

  const auto copy = std::make_shared<CopyOptions>();
  CLI::App* out = map->add_subcommand("export", "Write a map into one file, for another server");
  out->add_option("NAME", copy->map)->required();
  out->add_option("FILE", copy->file, "The file, or - for standard output")->required();
  out->add_flag("--no-images", copy->without_images, "Without the images' bytes: words and edges only");
  out->callback([=, &context] { context.action = [=, &context] { return export_map(context, *copy); }; });

  CLI::App* in = map->add_subcommand("import", "Make a map of a file that was exported, here or elsewhere");
  in->add_option("FILE", copy->file)->required();
  in->add_option("--name", copy->name, "Another name than the one that it had");
  in->callback([=, &context] { context.action = [=, &context] { return import_map(context, *copy); }; });

  CLI::App* gone = map->add_subcommand("delete", "Delete a map with its images; a merged map goes with its merge");
  gone->add_option("NAME", options->name)->required();
  gone->callback([=, &context] { context.action = [=, &context] { return remove(context, options->name); }; });
}

}  // namespace mapweld::command
