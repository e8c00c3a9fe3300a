#include "server/training/train.h"

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>
#include <thread>

#include <CLI/CLI.hpp>
#include <opencv2/core/utility.hpp>
#include <unistd.h>

#include "core/errors.h"
#include "core/feature/allocation.h"
#include "server/training/descriptor_file.h"
#include "server/training/interrupt.h"
#include "server/training/training.h"

namespace mapweld {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

constexpr int kFailed = 1;
constexpr int kInterrupted = 130;

struct TrainArguments {
  TrainingOptions training;
  fs::path out;
  fs::path report;
};

std::string format_duration(double seconds) {
  const auto total = static_cast<long>(seconds + 0.5);
  char text[32];
  if (total >= 3600) {
    std::snprintf(text, sizeof text, "%ld h %02ld min", total / 3600, total / 60 % 60);
  } else if (total >= 60) {
    std::snprintf(text, sizeof text, "%ld min %02ld s", total / 60, total % 60);
  } else {
    std::snprintf(text, sizeof text, "%ld s", total);
  }
  return text;
}

// One line on stderr: rewritten on a terminal, now and then a new one in a log.
class ProgressLine {
 public:
  void show(const std::string& stage, std::uint64_t done, std::uint64_t total) {
    const auto now = Clock::now();
    if (stage != stage_) {
      end();
      stage_ = stage;
      started_ = now;
      done_at_start_ = done;
    } else if (now - shown_ < (terminal_ ? std::chrono::milliseconds(200) : std::chrono::seconds(10))) {
      return;
    }
    shown_ = now;
    const double elapsed_s = std::chrono::duration<double>(now - started_).count();
    std::string line = stage;
    if (total > 0) {
      line += ": " + std::to_string(done) + " of " + std::to_string(total);
      if (done > done_at_start_) {
        const double rate = static_cast<double>(done - done_at_start_) / elapsed_s;
        line += ", " + format_duration(static_cast<double>(total - done) / rate) + " left";
      }
    } else {
      line += ": " + format_duration(elapsed_s);
    }
    std::fprintf(stderr, terminal_ ? "\r%s\033[K" : "%s\n", line.c_str());
  }

  void end() {
    if (terminal_ && !stage_.empty()) std::fputc('\n', stderr);
    stage_.clear();
  }

 private:
  bool terminal_ = isatty(STDERR_FILENO) != 0;
  std::string stage_;
  Clock::time_point started_;
  Clock::time_point shown_;
  std::uint64_t done_at_start_ = 0;
};

void run_train(TrainArguments arguments) {
  TrainingOptions& training = arguments.training;
  const bool own_work = training.work.empty();
  if (own_work) training.work = arguments.out.string() + ".work";
  keep_freed_memory();
  cv::setNumThreads(1);  // images are shared out among threads; a second layer of them only gets in the way

  const InterruptFlag interrupt;
  ProgressLine progress;
  const auto trained =
      train_vocabulary(training, [&](const std::string& stage, std::uint64_t done, std::uint64_t total) {
        progress.show(stage, done, total);
        if (!InterruptFlag::raised()) return true;
        progress.end();
        std::fprintf(stderr, "Interrupted. The same command goes on from what %s remembers.\n",
                     training.work.string().c_str());
        return false;
      });
  progress.end();
  if (!trained) throw CLI::RuntimeError(kInterrupted);

  for (const SkippedImage& image : trained->report.skipped) {
    std::fprintf(stderr, "Skipped %s: %s\n", image.path.c_str(), image.reason.c_str());
  }
  replace_file(arguments.out, trained->file);
  const std::string report = format_report(trained->report, training);
  if (!arguments.report.empty()) {
    replace_file(arguments.report, std::span(reinterpret_cast<const std::uint8_t*>(report.data()), report.size()));
  }
  std::printf("%s\nWritten: %s, %zu bytes\n", report.c_str(), arguments.out.string().c_str(), trained->file.size());
  if (own_work) {
    std::error_code ignored;
    fs::remove_all(training.work, ignored);
  }
}

}  // namespace

void add_train_command(CLI::App& app) {
  auto arguments = std::make_shared<TrainArguments>();
  TrainingOptions& training = arguments->training;
  training.trainer.threads = static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));

  CLI::App* train = app.add_subcommand("train", "Train a vocabulary on photographs");
  auto* images = train->add_option("--images", training.images, "Folders of JPEG and PNG files, searched recursively")
                     ->check(CLI::ExistingDirectory);
  train->add_option("--descriptors", training.descriptors, "A file of SIFT descriptors, 128 bytes each, instead")
      ->check(CLI::ExistingFile)
      ->excludes(images);
  train->add_option("--out", arguments->out, "The vocabulary file to write")->required();
  train->add_option("--words", training.trainer.words, "Number of visual words")
      ->capture_default_str()
      ->check(CLI::Range(1u, 1u << 22));
  train->add_option("--iterations", training.iterations, "Lloyd iterations after the hierarchical start")
      ->capture_default_str()
      ->check(CLI::Range(0, 1000));
  train->add_option("--max-features-per-image", training.max_features_per_image, "The strongest; 0: all")
      ->capture_default_str()
      ->check(CLI::Range(0, 1'000'000));
  train->add_option("--start-sample", training.trainer.start_sample, "Features that the hierarchical start sees")
      ->capture_default_str();
  train->add_option("--seed", training.trainer.seed, "The same seed and images give the same vocabulary")
      ->capture_default_str();
  train->add_option("--threads", training.trainer.threads, "Changes the time, not the result")
      ->capture_default_str()
      ->check(CLI::Range(1, 1024));
  train->add_option("--engine", training.trainer.index.engine, "Word index to store: hnsw, flann or exact")
      ->capture_default_str()
      ->check(CLI::IsMember({"hnsw", "flann", "exact"}));
  train->add_option(
      "--work", training.work,
      "Folder for intermediate files; kept. Default: the vocabulary file's name and .work, removed at the end");
  train->add_option("--report", arguments->report, "Write the report to this Markdown file as well");

  train->callback([arguments] {
    if (arguments->training.images.empty() && arguments->training.descriptors.empty()) {
      throw CLI::RequiredError("--images");
    }
    try {
      run_train(*arguments);
    } catch (const TrainingFileError& error) {
      std::fprintf(stderr, "mapweld-server train: %s\n", error.what());
      throw CLI::RuntimeError(kFailed);
    } catch (const FormatError& error) {
      std::fprintf(stderr, "mapweld-server train: %s\n", error.what());
      throw CLI::RuntimeError(kFailed);
    }
  });
}

}  // namespace mapweld
