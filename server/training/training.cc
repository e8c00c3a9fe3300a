#include "server/training/training.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdlib>
#include <exception>
#include <future>
#include <memory>
#include <thread>

#include <sys/resource.h>

#include "core/errors.h"
#include "core/feature/decode.h"
#include "core/feature/extractor.h"
#include "core/vocabulary/byte_stream.h"
#include "core/vocabulary/vocabulary.h"
#include "server/training/descriptor_file.h"

namespace mapweld {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kHoldOutEvery = 50;        // images
constexpr std::uint64_t kMaxEvaluated = 20'000;  // descriptors
constexpr std::size_t kImagesPerCheckpoint = 64;
constexpr int kInterruptedExitCode = 130;

class Stopwatch {
 public:
  double elapsed_s() const { return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count(); }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

// Thrown through the stages when the observer asks to stop.
struct Stopped {};

struct ExtractedImage {
  std::vector<std::uint8_t> descriptors;
  std::string error;  // why it was skipped
};

ExtractedImage extract(const fs::path& path, int max_features) {
  try {
    const DecodedImage image = decode_image(read_file(path));
    return {extract_features(image.grey, {max_features}, image.used).descriptors, {}};
  } catch (const std::exception& error) {
    return {{}, error.what()};
  }
}

class Training {
 public:
  Training(const TrainingOptions& options, const TrainingObserver& observer)
      : options_(options), observer_(observer), state_path_(options.work / "state") {
    if (options_.descriptors.empty()) {
      images_ = find_images(options_.images);
      if (images_.empty()) throw FormatError("there is no JPEG or PNG in the folders named");
    }
    std::error_code error;
    fs::create_directories(options_.work, error);
    if (error) throw TrainingFileError("cannot create " + options_.work.string() + ": " + error.message());
    const std::uint64_t fingerprint = compute_fingerprint();
    if (auto found = load_checkpoint(state_path_)) {
      if (found->fingerprint != fingerprint) {
        throw FormatError(options_.work.string() +
                          " remembers a training of other images or with other options; remove it or name another");
      }
      checkpoint_ = std::move(*found);
    }
    checkpoint_.fingerprint = fingerprint;
  }

  TrainedVocabulary run() {
    if (options_.descriptors.empty()) {
      extract_all();
      trained_file_ = std::make_unique<DescriptorFile>(train_path(), checkpoint_.descriptors);
    } else {
      trained_file_ = std::make_unique<DescriptorFile>(options_.descriptors);
      checkpoint_.held_out = std::min(kMaxEvaluated, trained_file_->size() / kHoldOutEvery);
      checkpoint_.descriptors = trained_file_->size() - checkpoint_.held_out;
    }
    const DescriptorRange source(*trained_file_, 0, checkpoint_.descriptors);
    start(source);
    iterate(source);
    return finish(source);
  }

 private:
  fs::path train_path() const { return options_.work / "descriptors"; }
  fs::path held_out_path() const { return options_.work / "held-out"; }

  void observe(const std::string& stage, std::uint64_t done, std::uint64_t total) const {
    if (observer_ && !observer_(stage, done, total)) throw Stopped{};
  }

  std::uint64_t compute_fingerprint() const {
    ByteWriter writer;
    const auto add_file = [&writer](const fs::path& path) {
      std::error_code error;
      writer.text(path.string());
      writer.number<std::uint64_t>(fs::file_size(path, error));
    };
    for (const fs::path& image : images_) add_file(image);
    if (!options_.descriptors.empty()) add_file(options_.descriptors);
    const TrainerOptions& trainer = options_.trainer;
    writer.number(options_.max_features_per_image);
    writer.number(trainer.words);
    writer.number(trainer.start_sample);
    writer.number(trainer.seed);
    writer.text(trainer.index.engine);
    writer.number(trainer.index.hnsw_links);
    writer.number(trainer.index.hnsw_build_effort);
    writer.number(trainer.index.hnsw_search_effort);
    writer.number(trainer.index.seed);
    return fnv1a(writer.take());
  }

  void extract_all() {
    if (checkpoint_.images_done == images_.size()) return;
    DescriptorWriter trained(train_path(), checkpoint_.descriptors);
    DescriptorWriter held_out(held_out_path(), checkpoint_.held_out);
    while (checkpoint_.images_done < images_.size()) {
      observe("features", checkpoint_.images_done, images_.size());
      const Stopwatch watch;
      const std::size_t first = checkpoint_.images_done;
      const std::size_t count = std::min(kImagesPerCheckpoint, images_.size() - first);
      const std::vector<ExtractedImage> extracted = extract_some(first, count);
      for (std::size_t i = 0; i < count; ++i) {
        if (!extracted[i].error.empty()) {
          checkpoint_.skipped.push_back({images_[first + i].string(), extracted[i].error});
          continue;
        }
        const bool hold_out = (first + i) % kHoldOutEvery == kHoldOutEvery - 1;
        (hold_out ? held_out : trained).append(extracted[i].descriptors);
      }
      trained.sync();
      held_out.sync();
      checkpoint_.images_done += count;
      checkpoint_.descriptors = trained.size();
      checkpoint_.held_out = held_out.size();
      checkpoint_.extraction_s += watch.elapsed_s();
      save_checkpoint(state_path_, checkpoint_);
    }
  }

  std::vector<ExtractedImage> extract_some(std::size_t first, std::size_t count) const {
    std::vector<ExtractedImage> extracted(count);
    std::atomic<std::size_t> next{0};
    const auto work = [&] {
      for (std::size_t i = next++; i < count; i = next++) {
        extracted[i] = extract(images_[first + i], options_.max_features_per_image);
      }
    };
    std::vector<std::jthread> threads;
    for (int i = 1; i < options_.trainer.threads; ++i) threads.emplace_back(work);
    work();
    return extracted;
  }

  void start(const DescriptorSource& source) {
    if (checkpoint_.kmeans) return;
    const Stopwatch watch;
    auto started = std::async(std::launch::async, [&] { return start_kmeans(source, options_.trainer); });
    using namespace std::chrono_literals;
    while (started.wait_for(100ms) != std::future_status::ready) {
      if (observer_ && !observer_("hierarchical start", 0, 0)) std::_Exit(kInterruptedExitCode);
    }
    checkpoint_.kmeans = started.get();
    checkpoint_.start_s = watch.elapsed_s();
    save_checkpoint(state_path_, checkpoint_);
  }

  void iterate(const DescriptorSource& source) {
    while (checkpoint_.kmeans->history.size() < static_cast<std::size_t>(options_.iterations)) {
      const Stopwatch watch;
      const std::string stage = "iteration " + std::to_string(checkpoint_.kmeans->history.size() + 1) + " of " +
                                std::to_string(options_.iterations);
      auto next =
          iterate_kmeans(source, *checkpoint_.kmeans, options_.trainer, [&](std::uint64_t done, std::uint64_t total) {
            observe(stage, done, total);
            return true;
          });
      checkpoint_.kmeans = std::move(*next);
      checkpoint_.iterations_s += watch.elapsed_s();
      save_checkpoint(state_path_, checkpoint_);
    }
  }

  TrainedVocabulary finish(const DescriptorSource& source) {
    observe("index", 0, 0);
    const Stopwatch watch;
    const Vocabulary vocabulary(order_by_locality(checkpoint_.kmeans->centroids), options_.trainer.index);
    TrainedVocabulary trained;
    TrainingReport& report = trained.report;
    report.index_s = watch.elapsed_s();
    trained.file = vocabulary.serialize();

    observe("evaluation", 0, 0);
    report.evaluated_on_held_out = checkpoint_.held_out > 0;
    report.evaluation = evaluate(evaluation_rows(source), vocabulary.centroids(), vocabulary.index());
    report.images = checkpoint_.images_done - checkpoint_.skipped.size();
    report.skipped = checkpoint_.skipped;
    report.descriptors = checkpoint_.descriptors;
    report.iterations = checkpoint_.kmeans->history;
    report.engine = vocabulary.index().engine();
    report.extraction_s = checkpoint_.extraction_s;
    report.start_s = checkpoint_.start_s;
    report.iterations_s = checkpoint_.iterations_s;
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    report.peak_memory_bytes = static_cast<std::uint64_t>(usage.ru_maxrss) * 1024;
    return trained;
  }

  // Held-out descriptors; when there are none, some of those trained on.
  std::vector<std::uint8_t> evaluation_rows(const DescriptorSource& source) const {
    std::unique_ptr<DescriptorSource> held_out;
    if (options_.descriptors.empty()) {
      if (checkpoint_.held_out > 0) {
        held_out = std::make_unique<DescriptorFile>(held_out_path(), checkpoint_.held_out);
      }
    } else if (checkpoint_.held_out > 0) {
      held_out = std::make_unique<DescriptorRange>(*trained_file_, checkpoint_.descriptors, checkpoint_.held_out);
    }
    const DescriptorSource& from = held_out ? *held_out : source;
    std::vector<std::uint8_t> rows;
    std::vector<std::uint8_t> row(kDescriptorDimension);
    for (const std::uint64_t i : sample_indices(from.size(), kMaxEvaluated, options_.trainer.seed)) {
      from.read(i, row);
      rows.insert(rows.end(), row.begin(), row.end());
    }
    return rows;
  }

  const TrainingOptions& options_;
  const TrainingObserver& observer_;
  fs::path state_path_;
  std::vector<fs::path> images_;
  TrainingCheckpoint checkpoint_;
  std::unique_ptr<DescriptorFile> trained_file_;
};

bool is_image_name(const fs::path& path) {
  std::string ending = path.extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](unsigned char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; });
  return ending == ".jpg" || ending == ".jpeg" || ending == ".png";
}

}  // namespace

std::vector<fs::path> find_images(const std::vector<fs::path>& folders) {
  std::vector<fs::path> images;
  for (const fs::path& folder : folders) {
    try {
      for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder)) {
        if (entry.is_regular_file() && is_image_name(entry.path())) images.push_back(entry.path());
      }
    } catch (const fs::filesystem_error& error) {
      throw TrainingFileError("cannot read " + folder.string() + ": " + error.code().message());
    }
  }
  std::sort(images.begin(), images.end());
  images.erase(std::unique(images.begin(), images.end()), images.end());
  return images;
}

std::optional<TrainedVocabulary> train_vocabulary(const TrainingOptions& options, const TrainingObserver& observer) {
  try {
    return Training(options, observer).run();
  } catch (const Stopped&) {
    return std::nullopt;
  }
}

}  // namespace mapweld
