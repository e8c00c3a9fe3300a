// mapweld localize MAP FILE...
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>

#include "client/command/camera_option.h"
#include "client/command/context.h"
#include "client/command/exit_code.h"
#include "client/command/terminal.h"
#include "client/image_folder.h"
#include "client/pose_file.h"

namespace mapweld::command {
namespace {

struct LocalizeCommandOptions {
  std::string map;
  std::vector<std::string> files;
  client::LocalizeOptions query;
  std::string camera;
};

std::string place_of(const contract::Match& match) {
  std::string place = printable(match.name);
  if (!match.map.empty()) place += " of " + match.map;
  return place;
}

// In words: how far the query's camera is turned against the match's, and where it stands as that one sees it.
std::string relative_text(const contract::Match& match) {
  if (!match.relative || match.relative->rotation_3x3.size() != 3) return "-";
  constexpr double kDegrees = 57.29577951308232;
  const auto& r = match.relative->rotation_3x3;
  const double trace = r[0].at(0) + r[1].at(1) + r[2].at(2);
  const double angle = std::acos(std::clamp((trace - 1) / 2, -1.0, 1.0)) * kDegrees;
  std::string text = "turned " + std::to_string(std::lround(angle)) + " deg";
  if (const auto& t = match.relative->direction; t && t->size() == 3) {
    const char* sides[3][2] = {{"left", "right"}, {"above", "below"}, {"behind", "ahead"}};
    for (const std::size_t axis : {2U, 0U, 1U}) {
      if (std::fabs((*t)[axis]) >= 0.38) text += std::string(", ") + sides[axis][(*t)[axis] > 0 ? 1 : 0];
    }
  }
  return text;
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
void add_rows(Table& table, const std::string& file, const contract::Localization& answer, bool all, bool relative) {
  const bool found = answer.status != "not_found";
  const auto row = [&](const std::string& first, const std::string& second, const contract::Match& match) {
    std::vector<std::string> cells = {first,
                                      second,
                                      place_of(match),
                                      std::to_string(match.vertex),
                                      std::to_string(match.votes),
                                      match.verified ? std::to_string(match.inliers) : "-"};
    if (relative) cells.push_back(relative_text(match));
    table.add(cells);
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

int localize(const Context& context, const LocalizeCommandOptions& given) {
  LocalizeCommandOptions options = given;
  options.query.camera_of_map = options.camera == "map";
  if (!options.camera.empty() && !options.query.camera_of_map) {
    options.query.camera = read_option([&] { return client::read_camera(options.camera); });
  }
  std::vector<std::string> images;  // all are read before anything is sent
  for (const std::string& file : options.files) images.push_back(client::read_file(file));
  client::Client server = context.connect();
  std::vector<std::string> columns = {"IMAGE", "STATUS", "PLACE", "VERTEX", "VOTES", "INLIERS"};
  if (!options.camera.empty()) columns.emplace_back("CAMERA");
  Table table(columns, {3, 4, 5});
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
        add_rows(table, file, *answer, options.query.limit.has_value(), !options.camera.empty());
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
  command->add_option("--camera", options->camera,
                      "The camera, as for upload, or \"map\" for the map's own: then it says how the two stand");
  command->add_flag("--verified", options->query.verified, "Only verified matches");
  command->footer("With --json: one line a file, in their order: the server's answer or its problem.");
  command->callback([=, &context] { context.action = [=, &context] { return localize(context, *options); }; });
}

}  // namespace mapweld::command
