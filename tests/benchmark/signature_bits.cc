// Which bits of a signature tell features of one word apart best: how the list of core/retrieval/vote_signature.cc was
// found, and how it is found again.
//
//   signature_bits [--bits N] [--every K] [--threads T]
//
// Photographs of the vocabulary's training set (MAPWELD_PHOTOS, none of a test place) are seen once as they are and
// once from another side: a random plane-to-plane map, other light, blur, noise, smaller or larger. A feature and its
// image under the map, both of one word, are a matching pair; features of one word in two photographs, a pair that does
// not match. Of every bit and every two bits it is counted how often they flip (together) in pairs of either kind; bits
// are then chosen one by one, and exchanged while that helps, so that
//   (mean distance of the others - mean distance of the matching)^2 / (sum of both variances)
// is largest. Printed: the bits, and how well they, all bits, and every other bit do on photographs not chosen from.
#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <mutex>
#include <random>
#include <string>
#include <thread>
#include <vector>

#include <CLI/CLI.hpp>
#include <opencv2/core/utility.hpp>
#include <opencv2/imgproc.hpp>

#include "core/feature/allocation.h"
#include "core/feature/decode.h"
#include "core/feature/extractor.h"
#include "core/vocabulary/signature.h"
#include "core/vocabulary/vocabulary.h"

namespace mapweld {
namespace {

namespace fs = std::filesystem;

constexpr int kBits = kDescriptorDimension;

std::vector<std::uint8_t> read(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) {
    std::fprintf(stderr, "cannot read %s\n", path.c_str());
    std::exit(1);
  }
  return {std::istreambuf_iterator<char>(file), {}};
}

std::vector<fs::path> photographs() {
  const char* set = std::getenv("MAPWELD_PHOTOS");
  const fs::path root = set != nullptr && *set != '\0' ? fs::path(set) : fs::path(MAPWELD_SOURCE_DIR "/../shared/data");
  std::vector<fs::path> files;
  for (const char* folder : {"vocabulary/houses", "vocabulary/doordetect"}) {
    for (const auto& entry : fs::directory_iterator(root / folder)) files.push_back(entry.path());
  }
  std::ranges::sort(files);
  return files;
}

struct Described {
  Features features;
  std::vector<WordId> words;
  std::vector<Signature> signatures;
};

Described describe(const cv::Mat& grey, const Vocabulary& vocabulary) {
  Described result{extract_features(grey), {}, {}};
  result.words = vocabulary.quantise(result.features);
  for (std::size_t i = 0; i < result.words.size(); ++i) {
    const std::span row(result.features.descriptors.data() + i * kDescriptorDimension, kDescriptorDimension);
    result.signatures.push_back(signature_of(row.first<kDescriptorDimension>()));
  }
  return result;
}

// The photograph from another side, and the map of its pixels to the other's.
struct OtherSide {
  cv::Mat grey;
  cv::Matx33d map;
};

OtherSide other_side(const cv::Mat& grey, std::mt19937& random) {
  const auto uniform = [&random](double low, double high) {
    return low + (high - low) * static_cast<double>(random()) / 4294967296.0;
  };
  const double width = grey.cols, height = grey.rows;
  const double zoom = std::exp(uniform(std::log(0.7), std::log(1.4)));
  const double turn = uniform(-0.25, 0.25);
  std::vector<cv::Point2f> from{
      {0, 0}, {grey.cols * 1.0F, 0}, {grey.cols * 1.0F, grey.rows * 1.0F}, {0, grey.rows * 1.0F}};
  std::vector<cv::Point2f> to;
  for (const cv::Point2f& corner : from) {
    const double x = corner.x - width / 2 + uniform(-0.12, 0.12) * width;
    const double y = corner.y - height / 2 + uniform(-0.12, 0.12) * height;
    to.emplace_back(static_cast<float>(width / 2 + zoom * (std::cos(turn) * x - std::sin(turn) * y)),
                    static_cast<float>(height / 2 + zoom * (std::sin(turn) * x + std::cos(turn) * y)));
  }
  OtherSide result;
  result.map = cv::Matx33d(cv::Mat(cv::getPerspectiveTransform(from, to)));
  cv::warpPerspective(grey, result.grey, result.map, grey.size(), cv::INTER_AREA, cv::BORDER_REFLECT);
  const double gain = uniform(0.5, 1.4), offset = uniform(-20, 20), gamma = uniform(0.7, 1.4);
  const double blur = uniform(0, 1.2), noise = uniform(0, 8);
  if (blur > 0.4) cv::GaussianBlur(result.grey, result.grey, {}, blur);
  for (int y = 0; y < result.grey.rows; ++y) {
    for (int x = 0; x < result.grey.cols; ++x) {
      std::uint8_t& pixel = result.grey.at<std::uint8_t>(y, x);
      const double normal = (uniform(-1, 1) + uniform(-1, 1) + uniform(-1, 1));
      const double lit = 255 * std::pow(pixel / 255.0, gamma) * gain + offset + noise * normal;
      pixel = static_cast<std::uint8_t>(std::clamp(lit, 0.0, 255.0));
    }
  }
  return result;
}

// Of each feature of `a` the one of `b` that lies where the map says, as large and turned as it says; -1: none.
std::vector<int> partners(const Features& a, const Features& b, const cv::Matx33d& map) {
  const auto moved = [&map](double x, double y) {
    const cv::Vec3d p = map * cv::Vec3d(x, y, 1);
    return cv::Point2d(p[0] / p[2], p[1] / p[2]);
  };
  std::vector<int> result;
  for (const Keypoint& p : a.keypoints) {
    const cv::Point2d at = moved(p.x_px, p.y_px);
    const double radians = p.angle_deg * std::acos(-1.0) / 180;
    const cv::Point2d tip = moved(p.x_px + std::cos(radians), p.y_px + std::sin(radians)) - at;
    const cv::Point2d right = moved(p.x_px + 1, p.y_px) - at, down = moved(p.x_px, p.y_px + 1) - at;
    const double zoom = std::sqrt(std::abs(right.x * down.y - right.y * down.x));
    const double angle = std::atan2(tip.y, tip.x) * 180 / std::acos(-1.0);
    int best = -1;
    double nearest = 2.5;
    for (std::size_t j = 0; j < b.keypoints.size(); ++j) {
      const Keypoint& q = b.keypoints[j];
      const double distance = std::hypot(q.x_px - at.x, q.y_px - at.y);
      if (distance >= nearest) continue;
      const double ratio = q.scale_px / (p.scale_px * zoom);
      const double turned = std::abs(std::remainder(q.angle_deg - angle, 360.0));
      if (ratio < 0.75 || ratio > 1.33 || turned > 22.5) continue;
      nearest = distance;
      best = static_cast<int>(j);
    }
    result.push_back(best);
  }
  return result;
}

using Flips = std::array<std::uint64_t, 2>;  // the bits in which a pair's signatures differ
Flips flips_of(const Signature& a, const Signature& b) {
  const auto half = [&](int k) {
    return std::uint64_t{a.bits[2 * k] ^ b.bits[2 * k]} | std::uint64_t{a.bits[2 * k + 1] ^ b.bits[2 * k + 1]} << 32;
  };
  return {half(0), half(1)};
}
bool flips(const Flips& pair, int bit) { return (pair[bit / 64] >> bit % 64 & 1) != 0; }
int distance(const Flips& pair, const Flips& mask) {
  return std::popcount(pair[0] & mask[0]) + std::popcount(pair[1] & mask[1]);
}
Flips mask_of(const std::vector<int>& bits) {
  Flips mask{};
  for (const int bit : bits) mask[bit / 64] |= std::uint64_t{1} << bit % 64;
  return mask;
}

struct Pairs {
  std::vector<Flips> matching, others;
};

// Even photographs are chosen from, odd ones tried on.
std::array<Pairs, 2> collect(const std::vector<fs::path>& files, const Vocabulary& vocabulary, int threads) {
  std::array<Pairs, 2> pairs;
  std::array<std::map<WordId, std::vector<Signature>>, 2> by_word;  // one feature a word and photograph
  std::mutex mutex;
  std::atomic<std::size_t> next{0};
  const auto work = [&] {
    for (std::size_t i = next++; i < files.size(); i = next++) {
      std::mt19937 random(static_cast<std::uint32_t>(i));
      cv::Mat grey;
      try {
        grey = decode_grey(read(files[i]));
      } catch (const std::exception&) {
        continue;
      }
      const OtherSide other = other_side(grey, random);
      const Described a = describe(grey, vocabulary), b = describe(other.grey, vocabulary);
      const std::vector<int> partner = partners(a.features, b.features, other.map);
      const std::lock_guard lock(mutex);
      for (std::size_t k = 0; k < partner.size(); ++k) {
        if (partner[k] < 0 || a.words[k] != b.words[static_cast<std::size_t>(partner[k])]) continue;
        pairs[i % 2].matching.push_back(flips_of(a.signatures[k], b.signatures[static_cast<std::size_t>(partner[k])]));
      }
      std::map<WordId, Signature> first;
      for (std::size_t k = 0; k < a.words.size(); ++k) first.emplace(a.words[k], a.signatures[k]);
      for (const auto& [word, signature] : first) by_word[i % 2][word].push_back(signature);
    }
  };
  {
    std::vector<std::jthread> workers;
    for (int t = 1; t < threads; ++t) workers.emplace_back(work);
    work();
  }
  for (int half = 0; half < 2; ++half) {
    for (const auto& [word, all] : by_word[half]) {
      for (std::size_t k = 1; k < all.size(); ++k) {
        for (std::size_t back = 1; back <= std::min<std::size_t>(k, 3); ++back) {
          pairs[half].others.push_back(flips_of(all[k], all[k - back]));
        }
      }
    }
  }
  return pairs;
}

// Means and covariances of the flips.
struct Moments {
  std::vector<double> mean = std::vector<double>(kBits), covariance = std::vector<double>(kBits * kBits);
};
Moments moments_of(const std::vector<Flips>& pairs) {
  std::vector<std::uint64_t> together(kBits * kBits);
  for (const Flips& pair : pairs) {
    std::array<int, kBits> set{};
    int count = 0;
    for (int bit = 0; bit < kBits; ++bit) {
      if (flips(pair, bit)) set[count++] = bit;
    }
    for (int i = 0; i < count; ++i) {
      for (int j = 0; j < count; ++j) ++together[set[i] * kBits + set[j]];
    }
  }
  Moments result;
  const auto n = static_cast<double>(pairs.size());
  for (int i = 0; i < kBits; ++i) result.mean[i] = static_cast<double>(together[i * kBits + i]) / n;
  for (int i = 0; i < kBits; ++i) {
    for (int j = 0; j < kBits; ++j) {
      result.covariance[i * kBits + j] =
          static_cast<double>(together[i * kBits + j]) / n - result.mean[i] * result.mean[j];
    }
  }
  return result;
}

std::vector<int> choose(const Pairs& pairs, int bits) {
  const Moments matching = moments_of(pairs.matching), others = moments_of(pairs.others);
  const auto merit = [&](const std::vector<int>& chosen) {
    double gap = 0, spread = 1e-9;
    for (const int i : chosen) {
      gap += others.mean[i] - matching.mean[i];
      for (const int j : chosen) spread += others.covariance[i * kBits + j] + matching.covariance[i * kBits + j];
    }
    return gap * std::abs(gap) / spread;
  };
  std::vector<int> chosen;
  const auto is_chosen = [&](int bit) { return std::ranges::find(chosen, bit) != chosen.end(); };
  const auto best_with = [&](std::vector<int> tried) {
    tried.push_back(0);
    std::pair<double, int> best{-1e9, -1};
    for (int bit = 0; bit < kBits; ++bit) {
      if (std::ranges::find(tried.begin(), tried.end() - 1, bit) != tried.end() - 1) continue;
      tried.back() = bit;
      best = std::max(best, std::pair(merit(tried), bit));
    }
    return best;
  };
  while (static_cast<int>(chosen.size()) < bits) chosen.push_back(best_with(chosen).second);
  for (bool is_better = true; is_better;) {
    is_better = false;
    for (std::size_t k = 0; k < chosen.size(); ++k) {
      const double before = merit(chosen);
      std::vector<int> without = chosen;
      without.erase(without.begin() + static_cast<std::ptrdiff_t>(k));
      const auto [after, bit] = best_with(without);
      if (bit < 0 || is_chosen(bit) || after <= before * (1 + 1e-9)) continue;
      chosen[k] = bit;
      is_better = true;
    }
  }
  std::ranges::sort(chosen);
  return chosen;
}

// Of pairs of either kind, how many lie at most so far apart.
void try_on(const char* name, const std::vector<int>& bits, const Pairs& pairs) {
  const Flips mask = mask_of(bits);
  std::array<std::vector<double>, 2> share;
  for (const auto* list : {&pairs.matching, &pairs.others}) {
    std::vector<double>& of = share[list == &pairs.others ? 1 : 0];
    of.assign(kBits + 1, 0);
    for (const Flips& pair : *list)
      of[static_cast<std::size_t>(distance(pair, mask))] += 1.0 / static_cast<double>(list->size());
  }
  double auc = 0, below = 0;
  std::string line;
  double matching = 0;
  for (int d = 0; d <= kBits; ++d) {
    const auto at = static_cast<std::size_t>(d);
    auc += share[1][at] * (below + share[0][at] / 2);
    below += share[0][at];
  }
  double others = 0;
  for (int d = 0; d <= static_cast<int>(bits.size()) / 4 + 2; ++d) {
    matching += share[0][static_cast<std::size_t>(d)];
    others += share[1][static_cast<std::size_t>(d)];
    if (matching < 0.3 || matching > 0.99) continue;
    char cell[64];
    std::snprintf(cell, sizeof cell, " %d: %.3f %.4f |", d, matching, others);
    line += cell;
  }
  std::printf("%s: AUC %.4f; at most d apart: matching, others:%s\n", name, auc, line.c_str());
}

}  // namespace
}  // namespace mapweld

int main(int argc, char** argv) {
  using namespace mapweld;
  int bits = 64, threads = 1;
  std::size_t every = 1;
  CLI::App app("Chooses the bits of signatures that votes go by");
  app.add_option("--bits", bits, "How many")->capture_default_str()->check(CLI::Range(1, kBits));
  app.add_option("--every", every, "Take each so many-th photograph")->capture_default_str();
  app.add_option("--threads", threads)->capture_default_str()->check(CLI::Range(1, 256));
  CLI11_PARSE(app, argc, argv);
  cv::setNumThreads(1);
  keep_freed_memory();

  std::vector<fs::path> files;
  const std::vector<fs::path> all = photographs();
  for (std::size_t i = 0; i < all.size(); i += every) files.push_back(all[i]);
  const auto vocabulary = Vocabulary::deserialize(read(MAPWELD_SOURCE_DIR "/vocabularies/indoor-50k.mwv"));
  const std::array<Pairs, 2> pairs = collect(files, *vocabulary, threads);
  std::printf("%zu photographs; %zu matching pairs and %zu others to choose from\n", files.size(),
              pairs[0].matching.size(), pairs[0].others.size());

  const std::vector<int> chosen = choose(pairs[0], bits);
  std::printf("bits:");
  for (const int bit : chosen) std::printf(" %d", bit);
  std::printf("\n");
  std::vector<int> every_bit(kBits), every_other;
  for (int bit = 0; bit < kBits; ++bit) every_bit[static_cast<std::size_t>(bit)] = bit;
  for (int bit = 0; bit < kBits; bit += kBits / bits) every_other.push_back(bit);
  try_on("all bits", every_bit, pairs[1]);
  try_on("every n-th bit", every_other, pairs[1]);
  try_on("chosen", chosen, pairs[1]);
  for (const int fewer : {bits / 2}) try_on("half as many, chosen", choose(pairs[0], fewer), pairs[1]);
  return 0;
}
