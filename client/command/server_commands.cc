// mapweld quality MAP, mapweld vocabularies, mapweld health
#include <memory>

#include "client/command/context.h"
#include "client/command/exit_code.h"
#include "client/command/terminal.h"

namespace mapweld::command {
namespace {

std::string whole_text(const contract::Quality& quality) {
  if (quality.components > 1) return "0 of the whole, which is not connected";
  return number_text(quality.algebraic_connectivity) + " of the whole, " +
         number_text(quality.weighted_algebraic_connectivity) + " weighted by inliers";
}

int quality(const Context& context, const std::string& map) {
  const auto answer = context.connect().quality(map);
  if (context.json) {
    print_json(answer.json);
    return kDone;
  }
  const contract::Quality& quality = *answer;
  std::vector<std::pair<std::string, std::string>> lines = {
      {"vertices", std::to_string(quality.vertices)},
      {"edges", edge_counts_text(quality.edge_counts)},
      {"components", std::to_string(quality.components)},
      {"largest component", count_text(quality.largest_component.vertices, "vertex", "vertices") +
                                ", algebraic connectivity " +
                                number_text(quality.largest_component.algebraic_connectivity)},
      {"algebraic connectivity", whole_text(quality)},
      {"minimum degree", std::to_string(quality.min_degree)},
      {"edge connectivity", std::to_string(quality.edge_connectivity)},
  };
  for (const contract::Joined& member : quality.joined) {
    lines.emplace_back("joined in " + member.map, count_text(member.vertices, "vertex", "vertices"));
  }
  if (!quality.joined.empty()) {
    lines.emplace_back("independent joins", std::to_string(quality.independent_joins) +
                                                " (removing as many images would split the members again)");
  }
  print(facts(lines));
  return kDone;
}

int vocabularies(const Context& context) {
  const auto all = context.connect().vocabularies();
  if (context.json) {
    print_json(all.json);
    return kDone;
  }
  Table table({"NAME", "WORDS", "DESCRIPTOR", "INDEX", "SHA-256", "CREATED"}, {1});
  for (const contract::Vocabulary& vocabulary : *all) {
    table.add({vocabulary.name, std::to_string(vocabulary.words),
               vocabulary.descriptor + " x " + std::to_string(vocabulary.dimension), vocabulary.index,
               vocabulary.sha256.substr(0, 12), time_text(vocabulary.created_at)});
  }
  print(table.text());
  return kDone;
}

int health(const Context& context) {
  client::Client server = context.connect();
  const contract::Json health = server.health();
  if (context.json) {
    print_json(health);
    return kDone;
  }
  contract::Json version = contract::Json::object();
  try {
    version = server.version();
  } catch (const client::ServerProblem& error) {
    if (error.status() != 401 && error.status() != 403) throw;
    print(server.base_url() + " is well, and asks for a key.\n");
    return kDone;
  }
  print(server.base_url() + " is well: mapweld-server " + version.value("version", std::string("?")) + ".\n");
  return kDone;
}

}  // namespace

void add_server_commands(CLI::App& app, Context& context) {
  const auto map = std::make_shared<std::string>();
  CLI::App* judged = app.add_subcommand("quality", "Say how well a map hangs together");
  judged->add_option("MAP", *map)->required();
  judged->callback([=, &context] { context.action = [=, &context] { return quality(context, *map); }; });

  CLI::App* words = app.add_subcommand("vocabularies", "List the server's vocabularies");
  words->callback([&context] { context.action = [&context] { return vocabularies(context); }; });

  CLI::App* well = app.add_subcommand("health", "Ask whether the server is there");
  well->callback([&context] { context.action = [&context] { return health(context); }; });
}

}  // namespace mapweld::command
