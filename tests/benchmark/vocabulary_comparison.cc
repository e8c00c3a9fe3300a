// How well places are recognised with one vocabulary and another: the table of docs/vocabulary.md, "Shipped or of the
// place".
//
//   vocabulary_comparison NAME=FILE.mwv ...
//
// Of two runs through one place, every image of the second is set against every image of the first: pairs with enough
// votes are verified, as a merge does that runs to its end, and an image is localized by its best verified pair.
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "core/feature/decode.h"
#include "core/feature/extractor.h"
#include "core/geometry/epipolar_verifier.h"
#include "core/mapping/localizer.h"
#include "core/retrieval/voting.h"
#include "core/vocabulary/appearance_vector.h"
#include "core/vocabulary/vocabulary.h"

namespace mapweld {
namespace {

namespace fs = std::filesystem;

std::vector<std::uint8_t> read(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) {
    std::fprintf(stderr, "cannot read %s\n", path.c_str());
    std::exit(1);
  }
  return {std::istreambuf_iterator<char>(file), {}};
}

fs::path photographs_folder() {
  const char* set = std::getenv("MAPWELD_PHOTOS");
  return set != nullptr && *set != '\0' ? fs::path(set) : fs::path(MAPWELD_SOURCE_DIR "/../shared/data");
}

struct Image {
  int number = 0;  // of its file name, or its place in the folder
  Features features;
};

std::vector<Image> extract(const fs::path& folder, bool by_place) {
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(folder)) files.push_back(entry.path());
  std::ranges::sort(files);
  std::vector<Image> images;
  for (const fs::path& file : files) {
    const int number = by_place ? static_cast<int>(images.size()) : std::atoi(file.stem().c_str());
    images.push_back({number, extract_features(decode_grey(read(file)))});
  }
  return images;
}

struct Accepted {
  int a = 0;  // number of the first run's image
  int b = 0;
  int inliers = 0;
};

std::vector<Accepted> accepted_pairs(const std::vector<Image>& first, const std::vector<Image>& second,
                                     const Vocabulary& vocabulary) {
  const auto in_words = [&](const std::vector<Image>& images) {
    std::vector<AppearanceVector> all;
    for (const Image& image : images) {
      all.push_back(make_appearance_vector(image.features, vocabulary.quantise(image.features)));
    }
    return all;
  };
  const auto a = in_words(first);
  const auto b = in_words(second);
  const MapParameters parameters;
  const auto verifier = make_verifier({.min_inliers = parameters.min_inliers});
  std::vector<Accepted> accepted;
  for (std::size_t j = 0; j < b.size(); ++j) {
    for (std::size_t i = 0; i < a.size(); ++i) {
      if (pair_votes(a[i], b[j], parameters.votes) < parameters.min_votes) continue;
      const Verification verdict = verifier->verify(a[i], b[j]);
      if (verdict.accepted) accepted.push_back({first[i].number, second[j].number, verdict.inliers});
    }
  }
  return accepted;
}

// Whether a pair shows one place.
using Truth = std::function<bool(const Accepted&)>;

Truth corridor_truth(const fs::path& table) {
  std::set<std::pair<int, int>> same;
  std::ifstream file(table);
  std::string line;
  std::getline(file, line);
  while (std::getline(file, line)) same.emplace(std::atoi(line.c_str() + line.find(',') + 1), std::atoi(line.c_str()));
  // The table is narrow: neighbours of a listed pair often match as well.
  return [same](const Accepted& pair) {
    return std::ranges::any_of(
        same, [&](const auto& s) { return std::abs(s.first - pair.a) <= 2 && std::abs(s.second - pair.b) <= 2; });
  };
}

// Both runs follow one route: a pair is right when it lies where the pairs of nearby images lie on the whole.
Truth route_truth(const std::vector<Accepted>& pairs) {
  constexpr int kNearFirst = 3;
  constexpr int kNearSecond = 30;
  return [pairs](const Accepted& pair) {
    std::vector<int> seconds;
    for (const Accepted& other : pairs) {
      if (std::abs(other.a - pair.a) <= kNearFirst) seconds.push_back(other.b);
    }
    std::ranges::nth_element(seconds, seconds.begin() + static_cast<std::ptrdiff_t>(seconds.size() / 2));
    return std::abs(seconds[seconds.size() / 2] - pair.b) <= kNearSecond;
  };
}

void print_row(const std::string& place, const std::string& name, std::size_t queries,
               const std::vector<Accepted>& accepted, const Truth& right) {
  std::map<int, Accepted> best;
  for (const Accepted& pair : accepted) {
    const auto [it, is_new] = best.try_emplace(pair.b, pair);
    if (!is_new && pair.inliers > it->second.inliers) it->second = pair;
  }
  const auto localized = std::ranges::count_if(best, [&](const auto& entry) { return right(entry.second); });
  const auto edges = std::ranges::count_if(accepted, right);
  double inliers = 0;
  for (const Accepted& pair : accepted) inliers += pair.inliers;
  std::printf("| %s | %s | %zu | %zu | %zu | %zu | %zu | %.1f |\n", place.c_str(), name.c_str(), queries,
              static_cast<std::size_t>(localized), best.size() - static_cast<std::size_t>(localized),
              static_cast<std::size_t>(edges), accepted.size() - static_cast<std::size_t>(edges),
              accepted.empty() ? 0 : inliers / static_cast<double>(accepted.size()));
}

int run(const std::vector<std::string>& arguments) {
  struct Named {
    std::string name;
    std::shared_ptr<const Vocabulary> vocabulary;
  };
  std::vector<Named> vocabularies;
  for (const std::string& argument : arguments) {
    const auto equals = argument.find('=');
    if (equals == std::string::npos) {
      std::fprintf(stderr, "usage: vocabulary_comparison NAME=FILE.mwv ...\n");
      return 1;
    }
    vocabularies.push_back({argument.substr(0, equals), Vocabulary::deserialize(read(argument.substr(equals + 1)))});
  }
  const fs::path root = photographs_folder();
  struct Place {
    std::string name;
    fs::path first;
    fs::path second;
    bool by_place;
  };
  const Place places[] = {
      {"corridor-two-laps", root / "corridor-two-laps/lap-1", root / "corridor-two-laps/lap-2", false},
      {"office-two-runs", root / "office-two-runs/reference", root / "office-two-runs/live", true},
      {"places-two-visits, shop", root / "places-two-visits/magasin/A", root / "places-two-visits/magasin/B", true},
      {"places-two-visits, studio", root / "places-two-visits/studio/A", root / "places-two-visits/studio/B", true}};
  std::printf("| place | vocabulary | images | localized | wrongly | edges | wrong | inliers an edge |\n");
  std::printf("|---|---|---|---|---|---|---|---|\n");
  for (const Place& place : places) {
    if (!fs::is_directory(place.first) || !fs::is_directory(place.second)) {
      std::fprintf(stderr, "%s is not here (MAPWELD_PHOTOS)\n", place.name.c_str());
      continue;
    }
    const auto first = extract(place.first, place.by_place);
    const auto second = extract(place.second, place.by_place);
    std::vector<std::vector<Accepted>> accepted;
    std::vector<Accepted> all;
    for (const Named& named : vocabularies) {
      accepted.push_back(accepted_pairs(first, second, *named.vocabulary));
      all.insert(all.end(), accepted.back().begin(), accepted.back().end());
    }
    Truth right = [](const Accepted& pair) { return std::abs(pair.a - pair.b) <= 1; };
    if (place.name == "corridor-two-laps") right = corridor_truth(root / "corridor-two-laps/same_place.csv");
    if (place.name == "office-two-runs") right = route_truth(all);
    for (std::size_t i = 0; i < vocabularies.size(); ++i) {
      print_row(place.name, vocabularies[i].name, second.size(), accepted[i], right);
    }
  }
  return 0;
}

}  // namespace
}  // namespace mapweld

int main(int argc, char** argv) { return mapweld::run({argv + 1, argv + argc}); }
