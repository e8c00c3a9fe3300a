// What a query's votes cost against large maps of made-up images (docs/votes.md).
#include <algorithm>
#include <cstdint>
#include <memory>
#include <vector>

#include <benchmark/benchmark.h>

#include "core/random.h"
#include "core/retrieval/inverted_index.h"
#include "core/retrieval/voting.h"

namespace mapweld {
namespace {

// Images of made-up words. Signatures of a word are strewn round one of its own, so that of two features of it about
// one pair in ten agrees, as in photographs.
class Images {
 public:
  explicit Images(std::uint64_t seed) : state_(seed) {}
  AppearanceVector next() {
    AppearanceVector image{.width_px = 320, .height_px = 240, .appearances = {}};
    for (int f = 0; f < kFeatures; ++f) {
      const auto word = static_cast<std::uint32_t>(next_random(state_) % kWords);
      image.appearances.push_back({WordId{word}, 0, 0, 4, 0, signature(word)});
    }
    std::ranges::sort(image.appearances);
    return image;
  }

 private:
  static constexpr int kWords = 50'000, kFeatures = 400;
  Signature signature(std::uint32_t word) {
    std::uint64_t own = word;
    Signature result;
    for (std::uint32_t& bits : result.bits) {
      // Each bit flips with a probability of an eighth.
      const auto flipped = static_cast<std::uint32_t>(next_random(state_) & next_random(state_) & next_random(state_));
      bits = static_cast<std::uint32_t>(next_random(own)) ^ flipped;
    }
    return result;
  }
  std::uint64_t state_;
};

const InvertedIndex& map_of(std::int64_t images) {
  static std::unique_ptr<InvertedIndex> map;  // one at a time: the largest takes gigabytes
  static std::int64_t size = -1;
  if (size != images) {
    map = std::make_unique<InvertedIndex>();
    Images made(1);
    for (std::int64_t i = 0; i < images; ++i) map->add(made.next());
    size = images;
  }
  return *map;
}

void Query(benchmark::State& state) {
  const InvertedIndex& map = map_of(state.range(0));
  const auto rule = static_cast<VoteRule>(state.range(1));
  std::vector<AppearanceVector> queries;
  for (Images made(2); queries.size() < 20;) queries.push_back(made.next());
  std::size_t q = 0, candidates = 0;
  const std::uint32_t min_votes = default_min_votes(rule);
  for (auto _ : state) candidates += vote(queries[q++ % queries.size()], map, rule, min_votes).candidates.size();
  state.counters["candidates"] = static_cast<double>(candidates) / static_cast<double>(q);
  state.counters["bytes an image"] = static_cast<double>(map.memory_bytes()) / static_cast<double>(state.range(0));
}
BENCHMARK(Query)->ArgsProduct({{2'000, 20'000, 200'000, 1'000'000}, {0, 2}})->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace mapweld
