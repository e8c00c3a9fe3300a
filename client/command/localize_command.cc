// mapweld localize MAP FILE...
#include <filesystem>
#include <memory>

#include "client/command/context.h"
#include "client/command/exit_code.h"
#include "client/command/terminal.h"
#include "client/image_folder.h"

namespace mapweld::command {
namespace {

struct LocalizeCommandOptions {
  std::string map;
  std::vector<std::string> files;
  client::LocalizeOptions query;
};

std::string place_of(const contract::Match& match) {
  std::string place = printable(match.name);
  if (!match.map.empty()) place += " of " + match.map;
  return place;
}

std::string explanation(const contract::Localization& answer) {
  const contract::Funnel& funnel = answer.funnel;
  return answer.reason.value_or("") + ": " + count_text(funnel.features, "feature") + ", " +
         count_text(funnel.known_words, "known word") + ", " + count_text(funnel.candidates, "candidate") + ", " +
         std::to_string(funnel.verified) + " verified, best " + std::to_string(funnel.best_inliers) + " of " +
         count_text(funnel.needed_inliers, "inlier") + " needed";
}

std::string status_text(const std::string& status) { return status == "not_found" ? "not found" : status; }

// The lines of one file: its best match, and the others when they were asked for.
void add_rows(Table& table, const std::string& file, const contract::Localization& answer, bool all) {
  const bool found = answer.status != "not_found";
  const auto row = [&](const std::string& first, const std::string& second, const contract::Match& match) {
    table.add({first, second, place_of(match), std::to_string(match.vertex), std::to_string(match.votes),
               match.verified ? std::to_string(match.inliers) : "-"});
  };
  if (found && !answer.matches.empty()) {
    row(file, status_text(answer.status), answer.matches[0]);
  } else {
    table.add({file, status_text(answer.status), explanation(answer)});
  }
  for (std::size_t i = found ? 1 : 0; i < answer.matches.size(); ++i) {
    const bool rival = answer.status == "ambiguous" && answer.matches[i].verified;
    if (all || rival) row("", answer.matches[i].verified ? "also" : "candidate", answer.matches[i]);
  }
}

int localize(const Context& context, const LocalizeCommandOptions& options) {
  std::vector<std::string> images;  // all are read before anything is sent
  for (const std::string& file : options.files) images.push_back(client::read_file(file));
  client::Client server = context.connect();
  Table table({"IMAGE", "STATUS", "PLACE", "VERTEX", "VOTES", "INLIERS"}, {3, 4, 5});
  std::size_t localized = 0;
  std::size_t refused = 0;
  for (std::size_t i = 0; i < images.size(); ++i) {
    const std::string file = printable(std::filesystem::path(options.files[i]).filename().string());
    try {
      const auto answer = server.localize(options.map, images[i], options.query);
      if (answer->status == "localized") ++localized;
      if (context.json) {
        print_json(answer.json);
      } else {
        add_rows(table, file, *answer, options.query.limit.has_value());
      }
    } catch (const client::ServerProblem& error) {
      const bool image_is_bad =
          error.status() == 413 || error.status() == 415 || error.status() == 422 || error.code() == "empty_body";
      if (!image_is_bad || images.size() == 1) throw;
      ++refused;
      if (context.json) {
        print_json(error.problem());
      } else {
        table.add({file, "refused", printable(error.detail()) + " (" + error.code() + ")"});
      }
    }
  }
  if (!context.json) {
    print(table.text());
    if (images.size() > 1) {
      print(std::to_string(localized) + " of " + count_text(static_cast<std::int64_t>(images.size()), "image") +
            " localized in " + options.map + ".\n");
    }
  }
  if (refused > 0) return kSomeRefused;
  return localized == images.size() ? kDone : kNotLocalized;
}

}  // namespace

void add_localize_command(CLI::App& app, Context& context) {
  const auto options = std::make_shared<LocalizeCommandOptions>();
  CLI::App* command = app.add_subcommand("localize", "Find the places of photographs in a map; changes nothing");
  command->add_option("MAP", options->map)->required();
  command->add_option("FILE", options->files, "JPEG or PNG files")->required()->check(CLI::ExistingFile);
  command->add_option("--limit", options->query.limit, "Matches to ask for, and to print")->check(CLI::Range(1, 1000));
  command->add_flag("--verified", options->query.verified, "Only verified matches");
  command->footer("With --json: one line a file, in their order: the server's answer or its problem.");
  command->callback([=, &context] { context.action = [=, &context] { return localize(context, *options); }; });
}

}  // namespace mapweld::command
