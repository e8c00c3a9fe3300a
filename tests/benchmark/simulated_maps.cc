#include "tests/benchmark/simulated_maps.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <random>
#include <utility>
#include <vector>

#include "core/random.h"
#include "tests/core/merge/toy_maps.h"

namespace mapweld::test {
namespace {

// A signature that `word` or another one gives, of which `own` flips one bit in 2^halvings.
Signature signature_near(Signature from, std::uint64_t word, std::uint64_t own, int halvings) {
  for (std::uint32_t& bits : from.bits) {
    std::uint32_t flips = ~0u;
    for (int k = 0; k < halvings; ++k) flips &= static_cast<std::uint32_t>(next_random(own));
    bits ^= flips ^ (word == 0 ? 0 : static_cast<std::uint32_t>(next_random(word)));
  }
  return from;
}

}  // namespace

MergeInput simulated_maps(std::uint32_t first, std::uint32_t second) {
  constexpr std::uint32_t kWords = 50000, kSeen = 300;
  std::mt19937 random(1);
  std::uint64_t noise = 1;
  const auto unit = [&random] { return static_cast<double>(random()) / 4294967296.0; };
  const auto zipf = [&] { return static_cast<std::uint32_t>(std::pow(kWords, unit()) - 1); };
  const auto any_word = [&] { return unit() < 0.1 ? zipf() : static_cast<std::uint32_t>(unit() * kWords); };
  const std::uint32_t places = first / 3;
  std::vector<std::vector<std::uint32_t>> landmarks(places);
  for (auto& words : landmarks) {
    for (int k = 0; k < 60; ++k) words.push_back(any_word());
  }
  MergeInput input;
  input.members = number_members({first, second});
  std::vector<std::shared_ptr<const AppearanceVector>> vectors;
  for (const std::uint32_t size : {first, second}) {
    for (std::uint32_t i = 0; i < size; ++i) {
      const double at = static_cast<double>(i) / size * places;
      AppearanceVector image;
      image.width_px = static_cast<int>(vectors.size()) + 1;
      image.height_px = 240;
      while (image.appearances.size() < kSeen) {
        const auto place = static_cast<std::uint32_t>(at + unit() * 3) % places;
        const bool is_noise = unit() < 0.55;
        const std::uint32_t landmark = random() % 60;
        const std::uint32_t word = is_noise ? any_word() : landmarks[place][landmark];
        // Two views of a landmark differ in a tenth of their bits or so, other features of a word in a quarter.
        const std::uint64_t own = is_noise ? next_random(noise) : (std::uint64_t{place} << 32 | landmark);
        image.appearances.push_back({WordId{word}, static_cast<float>(random() % 320), 0, 4, 0,
                                     signature_near(signature_near({}, word, own, 3), 0, next_random(noise), 4)});
      }
      std::sort(image.appearances.begin(), image.appearances.end());
      vectors.push_back(std::make_shared<const AppearanceVector>(std::move(image)));
    }
  }
  for (const MergeMember& member : input.members) {
    for (std::size_t i = 1; i < member.vertices.size(); ++i) {
      for (std::size_t back = 1; back <= std::min<std::size_t>(i, 4); ++back) {
        input.inner_edges.push_back({member.vertices[i - back], member.vertices[i], 60});
      }
    }
  }
  input.appearances = std::make_shared<AppearanceTable>(std::move(vectors));
  input.verifier = std::make_shared<HashVerifier>(0.3);
  input.options = {"quickconnect", 12, VoteRule::kMin, 1};
  return input;
}

}  // namespace mapweld::test
