// mapweld graph MAP
#include <memory>

#include "client/command/context.h"
#include "client/command/exit_code.h"
#include "client/command/output_file.h"
#include "client/drawing/graph_svg.h"

namespace mapweld::command {
namespace {

struct GraphOptions {
  std::string map;
  std::string format = "svg";
  std::string out;
  drawing::GraphSvgOptions svg;
};

int graph(const Context& context, const GraphOptions& options) {
  client::Client server = context.connect();
  OutputFile out(options.out);
  const std::string format = context.json ? "json" : options.format;
  if (format == "svg") {
    out.write(drawing::graph_svg(options.map, server.graph(options.map), options.svg));
  } else {
    server.export_graph(options.map, format, [&](std::string_view bytes) { out.write(bytes); });
  }
  out.commit();
  return kDone;
}

}  // namespace

void add_graph_command(CLI::App& app, Context& context) {
  const auto options = std::make_shared<GraphOptions>();
  CLI::App* command = app.add_subcommand("graph", "Draw or export the graph of a map");
  command->add_option("MAP", options->map)->required();
  command->add_option("--format", options->format, "svg (the paper's figure 4), graphml, dot, csv or json")
      ->check(CLI::IsMember({"svg", "graphml", "dot", "csv", "json"}))
      ->capture_default_str();
  command->add_flag("--unconfirmed", options->svg.unconfirmed,
                    "svg: draw the edges that are verified and not confirmed too, grey and dashed");
  command->add_option("--out", options->out, "A file (default: standard output)");
  command->callback([=, &context] { context.action = [=, &context] { return graph(context, *options); }; });
}

}  // namespace mapweld::command
