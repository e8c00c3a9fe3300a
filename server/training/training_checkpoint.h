// What a training remembers in its work folder, so that it goes on where it was interrupted.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/vocabulary/trainer.h"

namespace mapweld {

// An image that gave no features because it could not be read.
struct SkippedImage {
  std::string path;
  std::string reason;
  friend bool operator==(const SkippedImage&, const SkippedImage&) = default;
};

struct TrainingCheckpoint {
  std::uint64_t fingerprint = 0;  // of the images and of every option that shapes the result
  std::uint64_t images_done = 0;  // in their order; skipped ones included
  std::uint64_t descriptors = 0;  // of those, in the file to train on
  std::uint64_t held_out = 0;     // and in the file kept for evaluation
  std::vector<SkippedImage> skipped;
  std::optional<KMeansState> kmeans;  // from the start on
  double extraction_s = 0;            // spent so far
  double start_s = 0;
  double iterations_s = 0;
  friend bool operator==(const TrainingCheckpoint&, const TrainingCheckpoint&) = default;
};

// Replaces the file at once: a crash leaves the old one or the new one. Throws TrainingFileError.
void save_checkpoint(const std::filesystem::path& path, const TrainingCheckpoint& checkpoint);

// nullopt when there is none. Throws FormatError when the file is torn, or of another version.
std::optional<TrainingCheckpoint> load_checkpoint(const std::filesystem::path& path);

// Writes a file under another name, flushes it to the disk and renames it. Throws TrainingFileError.
void replace_file(const std::filesystem::path& path, std::span<const std::uint8_t> bytes);
// Throws TrainingFileError.
std::vector<std::uint8_t> read_file(const std::filesystem::path& path);

// FNV-1a, continued from `hash`.
std::uint64_t fnv1a(std::span<const std::uint8_t> bytes, std::uint64_t hash = 0xCBF29CE484222325u);

}  // namespace mapweld
