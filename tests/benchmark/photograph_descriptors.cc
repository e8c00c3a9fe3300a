#include "tests/benchmark/photograph_descriptors.h"

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "core/feature/decode.h"
#include "core/feature/extractor.h"

namespace mapweld::test {
namespace {

namespace fs = std::filesystem;

std::vector<std::uint8_t> read(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

}  // namespace

std::vector<std::uint8_t> photograph_descriptors(std::size_t step, std::size_t limit) {
  const char* set = std::getenv("MAPWELD_PHOTOS");
  const fs::path root = set != nullptr && *set != '\0' ? fs::path(set) : fs::path(MAPWELD_SOURCE_DIR "/../shared/data");
  std::vector<fs::path> files;
  for (const char* name : {"corridor-two-laps", "office-two-runs", "places-two-visits"}) {
    if (!fs::is_directory(root / name)) continue;
    for (const auto& entry : fs::recursive_directory_iterator(root / name)) {
      const auto ending = entry.path().extension();
      if (ending == ".jpg" || ending == ".jpeg" || ending == ".png") files.push_back(entry.path());
    }
  }
  std::ranges::sort(files);
  std::vector<std::uint8_t> descriptors;
  for (std::size_t i = 0; i < files.size(); i += step) {
    const Features features = extract_features(decode_grey(read(files[i])));
    descriptors.insert(descriptors.end(), features.descriptors.begin(), features.descriptors.end());
  }
  descriptors.resize(std::min(descriptors.size(), limit * kDescriptorDimension));
  return descriptors;
}

std::vector<std::uint8_t> shipped_vocabulary_file() { return read(MAPWELD_SOURCE_DIR "/vocabularies/indoor-50k.mwv"); }

}  // namespace mapweld::test
