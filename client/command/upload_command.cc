// mapweld upload MAP DIR
#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <memory>
#include <thread>

#include "client/command/camera_option.h"
#include "client/command/context.h"
#include "client/command/exit_code.h"
#include "client/command/terminal.h"
#include "client/image_folder.h"
#include "client/pose_file.h"
#include "client/upload.h"

namespace mapweld::command {
namespace {

using Clock = std::chrono::steady_clock;
using client::UploadedFile;
using client::UploadReport;

double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

// Progress on standard error: a bar that is redrawn on a terminal, a line every few seconds elsewhere.
class UploadProgress {
 public:
  explicit UploadProgress(std::string map) : map_(std::move(map)), terminal_(is_terminal(stderr)), panel_(stderr) {}

  void show(const UploadReport& report) {
    const double elapsed_s = seconds_since(start_);
    const std::int64_t sent = report.settled() - report.skipped;
    const double rate = elapsed_s > 0 ? static_cast<double>(sent) / elapsed_s : 0;
    const std::int64_t left = report.files - report.settled();
    if (terminal_) {
      const double fraction =
          report.files > 0 ? static_cast<double>(report.settled()) / static_cast<double>(report.files) : 1;
      char rate_text[48] = "";
      if (rate > 0) std::snprintf(rate_text, sizeof rate_text, "  %.0f images/s", rate);
      std::string line = map_ + "  " + bar(fraction, 30) + " " + std::to_string(report.settled()) + "/" +
                         std::to_string(report.files) + rate_text;
      if (rate > 0 && left > 0) line += "  " + duration_text(static_cast<double>(left) / rate) + " left";
      if (report.refused > 0) line += "  " + std::to_string(report.refused) + " refused";
      panel_.draw({line});
    } else if (elapsed_s - last_line_s_ >= 2 || left == 0) {
      if (report.settled() == last_settled_) return;
      std::fprintf(stderr, "%s: %lld of %lld images, %.1f s\n", map_.c_str(), static_cast<long long>(report.settled()),
                   static_cast<long long>(report.files), elapsed_s);
      last_line_s_ = elapsed_s;
      last_settled_ = report.settled();
    }
  }

  // A line that stays, above the bar.
  void say(const std::string& line) {
    panel_.clear();
    std::fprintf(stderr, "%s\n", line.c_str());
  }
  void done() { panel_.clear(); }
  double elapsed_s() const { return seconds_since(start_); }

 private:
  std::string map_;
  bool terminal_;
  Panel panel_;
  Clock::time_point start_ = Clock::now();
  double last_line_s_ = 0;
  std::int64_t last_settled_ = 0;
};

std::string summary(const client::UploadOptions& options, const UploadReport& report, double elapsed_s) {
  std::string text = count_text(report.files, "image") + " of " + printable(options.directory.string()) + ": " +
                     std::to_string(report.inserted) + " inserted, " + std::to_string(report.ignored) +
                     " ignored as too similar or identical";
  if (report.skipped > 0) text += ", " + std::to_string(report.skipped) + " there already";
  if (report.refused > 0) text += ", " + std::to_string(report.refused) + " refused";
  const std::int64_t sent = report.inserted + report.ignored;
  text += " (" + duration_text(elapsed_s);
  if (sent > 0) {
    text += ", " + std::to_string(std::llround(1000 * elapsed_s / static_cast<double>(sent))) + " ms an image";
  }
  return text + ").\n";
}

struct UploadCommandOptions : client::UploadOptions {
  std::string camera_text;
  std::string poses_file;
  std::string frame = "world";
};

int upload(const Context& context, const UploadCommandOptions& given) {
  client::UploadOptions options = given;
  if (!given.camera_text.empty()) {
    options.camera = read_option([&] { return client::read_camera(given.camera_text); });
  }
  if (!given.poses_file.empty()) {
    options.poses = read_option([&] { return client::read_poses(given.poses_file, given.frame); });
  }
  if (!std::filesystem::is_directory(options.directory)) {
    throw UsageError(options.directory.string() + " is not a folder.");
  }
  if (client::image_files(options.directory).empty()) {
    throw UsageError(options.directory.string() + " has no .jpg, .jpeg or .png file.");
  }
  client::Client server = context.connect();
  UploadProgress progress(options.map);
  contract::Json items = contract::Json::array();
  client::UploadObserver observer;
  observer.progress = [&](const UploadReport& report) { progress.show(report); };
  observer.retry = [&](const std::string& why, double wait_s) {
    progress.say(why + " Trying again in " + duration_text(wait_s) + ".");
  };
  observer.file = [&](const UploadedFile& file) {
    const auto* problem = std::get_if<contract::Problem>(&file.item);
    if (file.outcome == UploadedFile::Outcome::kRefused && problem != nullptr) {
      progress.say(printable(file.name + ": " + problem->detail + " (" + problem->code + ")"));
    }
    if (context.json && file.outcome != UploadedFile::Outcome::kSkipped) {
      contract::Json item = std::visit([](const auto& one) { return contract::Json(one); }, file.item);
      if (problem != nullptr) item["name"] = file.name;
      items.push_back(std::move(item));
    }
  };
  const UploadReport report = client::upload_directory(server, options, observer);
  progress.done();
  if (context.json) {
    contract::Json json;
    json["map"] = options.map;
    json["files"] = report.files;
    json["inserted"] = report.inserted;
    json["ignored"] = report.ignored;
    json["skipped"] = report.skipped;
    json["refused"] = report.refused;
    json["elapsed_s"] = progress.elapsed_s();
    json["items"] = std::move(items);
    print_json(json);
  } else {
    print(summary(options, report, progress.elapsed_s()));
  }
  return report.refused > 0 ? kSomeRefused : kDone;
}

}  // namespace

void add_upload_command(CLI::App& app, Context& context) {
  const auto options = std::make_shared<UploadCommandOptions>();
  options->threads = static_cast<int>(std::clamp(std::thread::hardware_concurrency(), 1U, 8U));
  CLI::App* command = app.add_subcommand(
      "upload",
      "Upload the photographs of a folder, in the byte order of their names; what the map has already is skipped");
  command->add_option("MAP", options->map)->required();
  command->add_option("DIR", options->directory, "A folder of .jpg, .jpeg and .png files")->required();
  command
      ->add_option("--threads", options->threads, "Threads that read files ahead; the map is the same for any number")
      ->check(CLI::Range(1, 256))
      ->capture_default_str();
  command->add_option("--batch", options->batch_images, "Images a request")
      ->check(CLI::Range(1, contract::kMaxBatchImages))
      ->capture_default_str();
  command->add_option("--camera", options->camera_text,
                      "The camera: fx,fy,cx,cy in pixels, perhaps with k1,k2,p1,p2 and k3, or a file with its JSON");
  command->add_option("--poses", options->poses_file,
                      "Where the images were taken: lines \"name tx ty tz qx qy qz qw\", camera to frame");
  command->add_option("--frame", options->frame, "What the poses' coordinates are of")->capture_default_str();
  command->callback([=, &context] { context.action = [=, &context] { return upload(context, *options); }; });
}

}  // namespace mapweld::command
