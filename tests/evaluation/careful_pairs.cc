#include "tests/evaluation/careful_pairs.h"

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <thread>

#include "core/feature/decode.h"

namespace mapweld::evaluation {
namespace {

namespace fs = std::filesystem;

constexpr const char* kHeader = "a_name,b_name,inliers";

fs::path file_of(const fs::path& folder, const Place& place) { return folder / (place.name + ".csv"); }

// Calls `work` with each number below `n`, on so many threads.
template <typename Work>
void each_of(std::size_t n, int threads, const Work& work) {
  std::atomic<std::size_t> next = 0;
  std::vector<std::jthread> workers;
  for (int t = 0; t < threads; ++t) {
    workers.emplace_back([&] {
      for (std::size_t i = next++; i < n; i = next++) work(i);
    });
  }
}

std::vector<CarefulImage> images_of(const std::string& folder, const std::vector<std::string>& names,
                                    const CarefulMatcherOptions& options, int threads) {
  std::vector<std::optional<CarefulImage>> found(names.size());
  each_of(names.size(), threads, [&](std::size_t i) {
    std::ifstream file(photographs_folder() / folder / names[i], std::ios::binary);
    const std::vector<std::uint8_t> bytes{std::istreambuf_iterator<char>(file), {}};
    found[i] = careful_image(decode_grey(bytes), options);
  });
  std::vector<CarefulImage> images;
  for (auto& image : found) images.push_back(std::move(image).value());
  return images;
}

}  // namespace

std::vector<CarefulPair> match_carefully(const Place& place, const CarefulMatcherOptions& options, int threads) {
  const std::vector<std::string> a_names = photograph_names(place.a), b_names = photograph_names(place.b);
  const std::vector<CarefulImage> a = images_of(place.a, a_names, options, threads);
  const std::vector<CarefulImage> b = images_of(place.b, b_names, options, threads);
  std::vector<int> inliers(a.size() * b.size());
  each_of(inliers.size(), threads,
          [&](std::size_t i) { inliers[i] = careful_inliers(a[i / b.size()], b[i % b.size()], options); });
  std::vector<CarefulPair> pairs;
  for (std::size_t i = 0; i < inliers.size(); ++i) {
    if (inliers[i] < options.min_inliers) continue;
    pairs.push_back({a_names[i / b.size()], b_names[i % b.size()], inliers[i]});
  }
  return pairs;
}

std::optional<std::vector<CarefulPair>> read_careful_pairs(const fs::path& folder, const Place& place) {
  std::ifstream file(file_of(folder, place));
  if (!file) return std::nullopt;
  std::string line;
  std::getline(file, line);
  if (line != kHeader) throw std::runtime_error(file_of(folder, place).string() + ": not the careful matcher's file");
  std::vector<CarefulPair> pairs;
  while (std::getline(file, line)) {
    const auto first = line.find(','), second = line.find(',', first + 1);
    if (second == std::string::npos) throw std::runtime_error(file_of(folder, place).string() + ": " + line);
    pairs.push_back(
        {line.substr(0, first), line.substr(first + 1, second - first - 1), std::stoi(line.substr(second + 1))});
  }
  return pairs;
}

void write_careful_pairs(const fs::path& folder, const Place& place, const std::vector<CarefulPair>& pairs) {
  const fs::path part = file_of(folder, place).string() + ".part";
  {
    std::ofstream file(part);
    file << kHeader << "\n";
    for (const CarefulPair& p : pairs) file << p.a_name << ',' << p.b_name << ',' << p.inliers << "\n";
    if (!file) throw std::runtime_error("cannot write " + part.string());
  }
  fs::rename(part, file_of(folder, place));
}

}  // namespace mapweld::evaluation
