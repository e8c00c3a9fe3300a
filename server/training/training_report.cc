#include <cstdio>
#include <string>

#include "server/training/training.h"

namespace mapweld {
namespace {

template <typename... Values>
std::string format(const char* pattern, Values... values) {
  const int size = std::snprintf(nullptr, 0, pattern, values...);
  std::string text(static_cast<std::size_t>(size), '\0');
  std::snprintf(text.data(), text.size() + 1, pattern, values...);
  return text;
}

std::string count(std::uint64_t value) {
  std::string digits = std::to_string(value);
  for (std::size_t at = digits.size(); at > 3;) {
    at -= 3;
    digits.insert(at, 1, ',');
  }
  return digits;
}

}  // namespace

std::string format_report(const TrainingReport& report, const TrainingOptions& options) {
  const TrainerOptions& trainer = options.trainer;
  std::string text = "# Training report\n\n| what | figure |\n|---|---|\n";
  const auto row = [&text](const std::string& what, const std::string& figure) {
    text += "| " + what + " | " + figure + " |\n";
  };
  row("words", count(trainer.words));
  if (options.descriptors.empty()) {
    row("images read", count(report.images));
    row("images skipped", count(report.skipped.size()));
  }
  row("features trained on", count(report.descriptors));
  row("seed", std::to_string(trainer.seed));
  row("Lloyd iterations", count(report.iterations.size()));
  row("distortion, squared distance a feature", format("%.0f", report.evaluation.mean_distortion));
  row("word index", report.engine);
  row("recall against exact search", format("%.2f %%", 100 * report.evaluation.recall));
  row("measured on", count(report.evaluation.descriptors) +
                         (report.evaluated_on_held_out ? " features not trained on" : " features trained on"));
  row("time: features", format("%.0f s", report.extraction_s));
  row("time: hierarchical start", format("%.0f s", report.start_s));
  row("time: iterations", format("%.0f s", report.iterations_s));
  row("time: index", format("%.0f s", report.index_s));
  row("threads", std::to_string(trainer.threads));
  row("peak memory", format("%.0f MB", static_cast<double>(report.peak_memory_bytes) / 1e6));

  text += "\n| iteration | distortion before it | empty words | components moved |\n|---|---|---|---|\n";
  for (std::size_t i = 0; i < report.iterations.size(); ++i) {
    const IterationReport& iteration = report.iterations[i];
    text += format("| %zu | %.0f | ", i + 1,
                   static_cast<double>(iteration.distortion) / static_cast<double>(report.descriptors));
    text += count(iteration.empty) + " | " + count(iteration.moved) + " |\n";
  }
  if (!report.skipped.empty()) {
    text += "\nSkipped:\n\n";
    for (const SkippedImage& image : report.skipped) text += "- " + image.path + ": " + image.reason + "\n";
  }
  return text;
}

}  // namespace mapweld
