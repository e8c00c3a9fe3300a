#include "tests/core/geometry/photographs.h"

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <map>
#include <memory>

#include "core/feature/decode.h"
#include "core/feature/extractor.h"
#include "core/vocabulary/appearance_vector.h"
#include "core/vocabulary/vocabulary.h"

namespace mapweld::test {
namespace {

namespace fs = std::filesystem;

std::vector<std::uint8_t> read_file(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

int number_of(const std::string& stem, std::size_t place) {
  const auto digit = stem.find_first_of("0123456789");
  return digit == std::string::npos ? static_cast<int>(place) : std::atoi(stem.c_str() + digit);
}

}  // namespace

fs::path photographs_folder() {
  const char* set = std::getenv("MAPWELD_PHOTOS");
  return set != nullptr && *set != '\0' ? fs::path(set) : fs::path(MAPWELD_SOURCE_DIR) / ".." / "shared" / "data";
}

const std::vector<Photograph>& photographs(const std::string& folder, std::size_t step) {
  static std::map<std::pair<std::string, std::size_t>, std::vector<Photograph>> read;
  static const std::shared_ptr<const Vocabulary> vocabulary = [] {
    const fs::path path = fs::path(MAPWELD_SOURCE_DIR) / "vocabularies" / "indoor-50k.mwv";
    return fs::exists(path) ? Vocabulary::deserialize(read_file(path)) : nullptr;
  }();
  const auto [it, is_new] = read.try_emplace({folder, step});
  const fs::path path = photographs_folder() / folder;
  if (!is_new || !vocabulary || !fs::is_directory(path)) return it->second;
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(path)) files.push_back(entry.path());
  std::ranges::sort(files);
  for (std::size_t i = 0; i < files.size(); i += step) {
    const Features features = extract_features(decode_grey(read_file(files[i])));
    it->second.push_back(
        {number_of(files[i].stem(), i), make_appearance_vector(features, vocabulary->quantise(features))});
  }
  return it->second;
}

std::set<std::pair<int, int>> corridor_same_place() {
  std::set<std::pair<int, int>> pairs;
  std::ifstream truth(photographs_folder() / "corridor-two-laps" / "same_place.csv");
  std::string line;
  std::getline(truth, line);
  while (std::getline(truth, line)) {
    pairs.emplace(std::atoi(line.c_str() + line.find(',') + 1), std::atoi(line.c_str()));
  }
  return pairs;
}

}  // namespace mapweld::test
