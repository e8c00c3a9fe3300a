// mapweld merge A B...
#include <memory>

#include "client/command/budget_options.h"
#include "client/command/context.h"
#include "client/command/exit_code.h"
#include "client/command/terminal.h"
#include "client/command/watch.h"

namespace mapweld::command {
namespace {

struct MergeCommandOptions {
  contract::SubmitMerge submit;
  contract::MergeParameters parameters;
  BudgetOptions budget;
  std::string idempotency_key;
  bool watch = false;
  bool wait = false;
};

int merge(const Context& context, const MergeCommandOptions& options) {
  contract::SubmitMerge request = options.submit;
  const contract::MergeParameters& parameters = options.parameters;
  if (parameters != contract::MergeParameters{}) request.parameters = parameters;
  request.budget = options.budget.budget();
  client::Client server = context.connect();
  const auto submitted = server.submit_merge(request, options.idempotency_key);
  const contract::Merge& merge = *submitted;
  if (!options.watch && !options.wait) {
    if (context.json) {
      print_json(submitted.json);
    } else {
      const std::string id = std::to_string(merge.id);
      print("Merge " + id + " is under way: " + members_text(merge) + ", " + merge.method + ".\n" +
            "Follow it: mapweld merges watch " + id + "\n");
    }
    return kDone;
  }
  if (options.wait) {
    const int code = watch(server, merge.id, WatchStyle::kSilent);
    if (code == kInterrupted) return code;
    const auto ended = server.merge(merge.id);
    if (context.json) {
      print_json(ended.json);
    } else {
      print(outcome_text(*ended) + "\n");
    }
    return code;
  }
  if (!context.json)
    print("Merge " + std::to_string(merge.id) + ": " + members_text(merge) + ", " + merge.method + "\n");
  return watch(server, merge.id, context.json ? WatchStyle::kJson : WatchStyle::kPeople);
}

}  // namespace

void add_merge_command(CLI::App& app, Context& context) {
  const auto options = std::make_shared<MergeCommandOptions>();
  CLI::App* command = app.add_subcommand("merge", "Merge maps; stop whenever you like, go on whenever you like");
  command->add_option("MAP", options->submit.maps, "Two maps or more; their order numbers the merged map's vertices")
      ->required()
      ->expected(2, 1000);
  command->add_option("--name", options->submit.name, "The merged map's name (default: the members' joined by \"_\")");
  command->add_option("--method", options->submit.method, "How the pairs are gone through (default: spectral)")
      ->check(CLI::IsMember(std::vector<std::string>(contract::kMergeMethods.begin(), contract::kMergeMethods.end())));
  command->add_option("--seed", options->submit.seed, "Of the methods that draw at random")
      ->check(CLI::NonNegativeNumber);
  command
      ->add_option("--votes", options->parameters.votes,
                   "What votes: equal words, or those whose signatures agree (default)")
      ->check(CLI::IsMember({"min", "product", "signatures"}));
  command->add_option("--min-votes", options->parameters.min_votes,
                      "Fewest votes of a candidate (default: 3 by signatures, 10 by words)");
  command->add_option("--min-inliers", options->parameters.min_inliers, "Fewest verified matches of an edge");
  command->add_flag_function(
      "--alias-guard,!--no-alias-guard", [options](std::int64_t times) { options->parameters.alias_guard = times > 0; },
      "Confirm only edges that fully show their place and that none contradicts, or all of them (default: spectral "
      "guards)");
  command->add_option("--min-confidence", options->parameters.min_confidence,
                      "How sure the guard must be of an edge that it confirms, 0 to 1");
  command->add_flag_function(
      "--serve-certificate,!--no-serve-certificate",
      [options](std::int64_t times) { options->parameters.serves_certificate = times > 0; },
      "Verify first what keeps the certificate low (default: with --certified)");
  command->add_option("--idempotency-key", options->idempotency_key,
                      "Any text of yours: sent again with the same one, it is begun once, and answered as before");
  options->budget.add_to(*command);
  CLI::Option* wait = command->add_flag("--wait", options->wait, "Return when the merge has come to rest");
  command->add_flag("--watch", options->watch, "The same, showing its progress")->excludes(wait);
  command->callback([=, &context] { context.action = [=, &context] { return merge(context, *options); }; });
}

}  // namespace mapweld::command
