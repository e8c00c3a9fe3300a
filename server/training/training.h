// Training a vocabulary from folders of images: the stages, their files and how they are interrupted and resumed. The
// algorithm itself is core/vocabulary/trainer.h.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "core/vocabulary/trainer.h"
#include "server/training/training_checkpoint.h"

namespace mapweld {

struct TrainingOptions {
  std::vector<std::filesystem::path> images;  // folders, searched recursively for JPEG and PNG by their names' endings
  std::filesystem::path descriptors;          // or a file of descriptors, 128 bytes a row, instead of images
  std::filesystem::path work;                 // folder for what is remembered; made when missing
  int max_features_per_image = 0;             // the strongest; 0: all
  int iterations = 8;                         // of Lloyd
  TrainerOptions trainer;
};

struct TrainingReport {
  std::uint64_t images = 0;  // read
  std::vector<SkippedImage> skipped;
  std::uint64_t descriptors = 0;  // trained on
  std::vector<IterationReport> iterations;
  Evaluation evaluation;               // of the index against exact search
  bool evaluated_on_held_out = false;  // else there were too few images to hold one out
  std::string engine;
  double extraction_s = 0;
  double start_s = 0;
  double iterations_s = 0;
  double index_s = 0;
  std::uint64_t peak_memory_bytes = 0;  // of this process
};

struct TrainedVocabulary {
  std::vector<std::uint8_t> file;  // Vocabulary::serialize()
  TrainingReport report;
};

// Told what is going on: a stage's name, work done and total (0: unknown). Called often; false asks to stop.
using TrainingObserver = std::function<bool(const std::string& stage, std::uint64_t done, std::uint64_t total)>;

// Trains, or goes on with what the work folder remembers. nullopt: stopped at the observer's wish; all but the last few
// seconds of work is remembered. The vocabulary's bytes are those of a training that was never interrupted, whatever
// the number of threads.
//
// Every 50th image is held out: its descriptors measure recall and train nothing. During the hierarchical start, which
// FLANN cannot leave, a wish to stop ends the process with code 130; what was extracted is safe by then.
// Throws TrainingFileError, and FormatError for too few descriptors or a work folder of another training.
std::optional<TrainedVocabulary> train_vocabulary(const TrainingOptions& options, const TrainingObserver& observer);

// The JPEG and PNG files below `folders`, sorted by path. Throws TrainingFileError when a folder cannot be read.
std::vector<std::filesystem::path> find_images(const std::vector<std::filesystem::path>& folders);

// The report as Markdown.
std::string format_report(const TrainingReport& report, const TrainingOptions& options);

}  // namespace mapweld
