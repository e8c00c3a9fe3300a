// mapweld merges [list|show|watch|pause|resume|restart|cancel|delete|edges|curve]
#include <memory>

#include "client/command/budget_options.h"
#include "client/command/context.h"
#include "client/command/exit_code.h"
#include "client/command/output_file.h"
#include "client/command/terminal.h"
#include "client/command/watch.h"
#include "client/drawing/curve_csv.h"
#include "client/drawing/curve_svg.h"

namespace mapweld::command {
namespace {

struct MergesOptions {
  std::int64_t id = 0;
  std::optional<std::string> state;
  BudgetOptions budget;
  bool watch = false;
  std::string format = "csv";
  std::string out;
};

int list(const Context& context, const MergesOptions& options) {
  const auto merges = context.connect().merges(options.state);
  if (context.json) {
    print_json(merges.json);
  } else if (merges->empty()) {
    print(options.state ? "There is no merge in this state.\n"
                        : "There is no merge yet. Begin one: mapweld merge MAP MAP\n");
  } else {
    Table table({"ID", "STATE", "PHASE", "METHOD", "MAPS", "CONFIRMED", "VERIFIED", "CONNECTIVITY", "TIME"},
                {0, 5, 6, 7, 8});
    for (const contract::Merge& merge : *merges) {
      table.add({std::to_string(merge.id), merge.state, merge.phase, merge.method, members_text(merge),
                 std::to_string(merge.edge_counts.confirmed), std::to_string(merge.edge_counts.verified),
                 number_text(merge.largest_component.algebraic_connectivity), duration_text(merge.elapsed_s)});
    }
    print(table.text());
  }
  return kDone;
}

int tell(const Context& context, const client::Answer<contract::Merge>& merge) {
  if (context.json) {
    print_json(merge.json);
  } else {
    print(outcome_text(*merge) + "\n");
  }
  return kDone;
}

std::string describe(const contract::Merge& merge) {
  std::vector<std::pair<std::string, std::string>> lines = {
      {"merge", std::to_string(merge.id) + ", " + members_text(merge)},
      {"method", merge.method + ", seed " + std::to_string(merge.seed)},
      {"state", merge.state + (merge.stop_reason ? " (" + *merge.stop_reason + ")" : std::string())},
      {"phase", merge.phase + ", step " + std::to_string(merge.step)},
      {"candidates", std::to_string(merge.candidates.verified) + " of " + std::to_string(merge.candidates.known) +
                         " verified, " + std::to_string(merge.candidates.accepted) + " passed"},
      {"edges between the maps", edge_counts_text(merge.edge_counts)},
      {"components", std::to_string(merge.components) + ", the largest of " +
                         count_text(merge.largest_component.vertices, "vertex", "vertices")},
      {"algebraic connectivity", number_text(merge.algebraic_connectivity) + " of the whole, " +
                                     number_text(merge.largest_component.algebraic_connectivity) +
                                     " of the largest component"},
  };
  if (merge.words.total > 0) {
    lines.emplace(lines.begin() + 4, "words",
                  std::to_string(merge.words.done) + " of " + std::to_string(merge.words.total));
  }
  for (const contract::Joined& member : merge.joined) {
    lines.emplace_back("joined in " + member.map, count_text(member.vertices, "vertex", "vertices"));
  }
  lines.emplace_back("independent joins", std::to_string(merge.independent_joins));
  if (merge.pairs.size() > 1) {
    for (const contract::MemberPair& pair : merge.pairs) {
      lines.emplace_back(pair.maps.front() + " and " + pair.maps.back(),
                         pair.verdict + ": edges " + edge_counts_text(pair.edge_counts) + "; " +
                             count_text(pair.verified, "candidate") + " looked at, " +
                             count_text(pair.independent_joins, "independent join"));
    }
  }
  if (merge.certified_fraction) {
    lines.emplace_back("of what can be reached", "at least " + number_text(100 * *merge.certified_fraction) +
                                                     " %, by estimate " +
                                                     number_text(100 * merge.estimated_fraction.value_or(0)) + " %");
    lines.emplace_back("could still join", count_text(merge.joinable_vertices.value_or(0), "vertex", "vertices"));
  }
  lines.emplace_back("time", duration_text(merge.elapsed_s));
  const contract::Json budget = merge.budget;
  lines.emplace_back("budget", budget.empty() ? "none" : contract::dump(budget));
  if (merge.eta_s) lines.emplace_back("to complete", "about " + duration_text(*merge.eta_s));
  if (merge.error) lines.emplace_back("error", printable(*merge.error));
  return facts(lines);
}

int show(const Context& context, std::int64_t id) {
  const auto merge = context.connect().merge(id);
  if (context.json) {
    print_json(merge.json);
  } else {
    print(describe(*merge));
  }
  return kDone;
}

int watch_one(const Context& context, std::int64_t id) {
  client::Client server = context.connect();
  return watch(server, id, context.json ? WatchStyle::kJson : WatchStyle::kPeople);
}

using Run = client::Answer<contract::Merge> (client::Client::*)(std::int64_t, const std::optional<contract::Budget>&);

// Sends a merge on its way by `run`; `says` how it goes, in words.
int run_one(const Context& context, const MergesOptions& options, Run run, const std::string& says) {
  client::Client server = context.connect();
  const auto merge = (server.*run)(options.id, options.budget.budget());
  if (options.watch) return watch(server, options.id, context.json ? WatchStyle::kJson : WatchStyle::kPeople);
  if (context.json) {
    print_json(merge.json);
  } else {
    print("Merge " + std::to_string(options.id) + " " + says + ".\n");
  }
  return kDone;
}

int remove(const Context& context, std::int64_t id) {
  context.connect().delete_merge(id);
  if (!context.json) print("Merge " + std::to_string(id) + " is undone; its maps are as they were.\n");
  return kDone;
}

int edges(const Context& context, std::int64_t id) {
  const auto edges = context.connect().merge_edges(id);
  if (context.json) {
    print_json(edges.json);
  } else {
    Table table({"U", "V", "VOTES", "INLIERS", "VERIFICATIONS", "TIME", "CONFIDENCE", "CONFIRMED"},
                {0, 1, 2, 3, 4, 5, 6});
    for (const contract::MergeEdge& edge : *edges) {
      table.add({std::to_string(edge.u), std::to_string(edge.v), std::to_string(edge.votes),
                 std::to_string(edge.inliers), std::to_string(edge.verifications), duration_text(edge.elapsed_s),
                 edge.confidence ? number_text(*edge.confidence) : "-",
                 edge.confirmed ? "yes" : "no: " + edge.reason.value_or("")});
    }
    print(table.text());
  }
  return kDone;
}

int curve(const Context& context, const MergesOptions& options) {
  client::Client server = context.connect();
  const auto points = server.curve(options.id);
  OutputFile out(options.out);
  if (context.json || options.format == "json") {
    out.write(contract::dump(points.json) + "\n");
  } else if (options.format == "csv") {
    out.write(drawing::curve_csv(*points));
  } else {
    const auto merge = server.merge(options.id);
    out.write(drawing::curve_svg(*merge, *points));
  }
  out.commit();
  return kDone;
}

}  // namespace

void add_merges_command(CLI::App& app, Context& context) {
  const auto options = std::make_shared<MergesOptions>();
  CLI::App* merges = app.add_subcommand("merges", "List, follow, stop, continue and undo merges");
  merges->require_subcommand(0, 1);
  const auto act = [=, &context](auto function) {
    return [=, &context] { context.action = [=, &context] { return function(context, *options); }; };
  };
  const auto add = [&](const char* name, const char* help, auto function) {
    CLI::App* command = merges->add_subcommand(name, help);
    command->callback(act(function));
    return command;
  };
  const auto add_for_one = [&](const char* name, const char* help, auto function) {
    CLI::App* command = add(name, help, function);
    command->add_option("ID", options->id, "The merge's number")->required()->check(CLI::NonNegativeNumber);
    return command;
  };
  // Callbacks run from the parent to the chosen subcommand: the last one set is the one that counts.
  merges->preparse_callback([=](std::size_t) { act(list)(); });

  add("list", "List the merges (the default)", list)
      ->add_option("--state", options->state, "Only those in this state")
      ->check(CLI::IsMember(std::vector<std::string>(contract::kMergeStates.begin(), contract::kMergeStates.end())));
  add_for_one("show", "Show one merge", [](const Context& c, const MergesOptions& o) { return show(c, o.id); });
  add_for_one("watch", "Follow a merge until it rests",
              [](const Context& c, const MergesOptions& o) { return watch_one(c, o.id); });
  add_for_one("pause", "Stop a merge at its next step",
              [](const Context& c, const MergesOptions& o) { return tell(c, c.connect().pause_merge(o.id)); });
  const auto add_run = [&](const char* name, const char* help, Run run, const char* says) {
    CLI::App* command =
        add_for_one(name, help, [=](const Context& c, const MergesOptions& o) { return run_one(c, o, run, says); });
    options->budget.add_to(*command);
    command->add_flag("--watch", options->watch, "Follow it until it rests");
  };
  add_run("resume", "Go on exactly where a merge stopped", &client::Client::resume_merge, "goes on");
  add_run("restart", "Begin a merge afresh; its edges go", &client::Client::restart_merge, "begins afresh");
  add_for_one("cancel", "End a merge; its edges stay",
              [](const Context& c, const MergesOptions& o) { return tell(c, c.connect().cancel_merge(o.id)); });
  add_for_one("delete", "Undo a merge: its merged map and its edges go",
              [](const Context& c, const MergesOptions& o) { return remove(c, o.id); });
  add_for_one("edges", "List a merge's edges in the order of their insertion",
              [](const Context& c, const MergesOptions& o) { return edges(c, o.id); });
  CLI::App* drawn = add_for_one("curve", "The anytime curve: how connectivity and edges grew", curve);
  drawn->add_option("--format", options->format, "csv, svg (the paper's figure 6) or json")
      ->check(CLI::IsMember({"csv", "svg", "json"}))
      ->capture_default_str();
  drawn->add_option("--out", options->out, "A file (default: standard output)");
}

}  // namespace mapweld::command
