// Voting, verification and localization: how fast, and how right. docs/verification.md says what the figures mean.
//
//   verifier_benchmark --benchmark_filter=Signatures|Vote|Verify|Localize   time
//   verifier_benchmark --benchmark_filter=Chance                   false acceptance of 100,000 chance pairs a layout
//   verifier_benchmark --benchmark_filter=Places|Corridor|Office   verdicts on photographs (MAPWELD_PHOTOS)
#include <algorithm>
#include <chrono>
#include <cmath>
#include <memory>
#include <optional>
#include <queue>
#include <random>
#include <string>
#include <vector>

#include <benchmark/benchmark.h>
#include <opencv2/calib3d.hpp>

#include "core/geometry/correspondences.h"
#include "core/geometry/epipolar_verifier.h"
#include "core/geometry/fundamental_matrix.h"
#include "core/geometry/nearest_signatures.h"
#include "core/geometry/robust_fundamental.h"
#include "core/geometry/word_matches.h"
#include "core/mapping/localizer.h"
#include "core/mapping/mapper.h"
#include "core/retrieval/inverted_index.h"
#include "core/retrieval/voting.h"
#include "tests/core/geometry/photographs.h"
#include "tests/core/geometry/two_view_scene.h"
#include "tests/core/mapping/scene_map.h"

namespace mapweld {
namespace {

using test::Photograph;
using test::photographs;

// ---- Signatures ----------------------------------------------------------------------------------------------------

// All of 350 signatures with all of 350 others, by the kernel of `simd`: 0 scalar, 1 AVX2.
void BM_NearestSignatures(benchmark::State& state) {
  constexpr std::uint32_t kFeatures = 350;
  std::mt19937 random(1);
  std::vector<Signature> a(kFeatures), b(kFeatures);
  for (auto* list : {&a, &b}) {
    for (Signature& signature : *list) {
      for (auto& part : signature.bits) part = static_cast<std::uint32_t>(random());
    }
  }
  const std::vector<Compared> all(kFeatures, Compared{0, kFeatures});
  const SignatureBlocks blocks(b);
  for (auto _ : state) {
    benchmark::DoNotOptimize(nearest_signatures(a, blocks, all, 31, static_cast<PopcountSimd>(state.range(0))));
  }
  state.counters["comparison"] =
      benchmark::Counter(static_cast<double>(kFeatures) * kFeatures * static_cast<double>(state.iterations()),
                         benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}
BENCHMARK(BM_NearestSignatures)->ArgName("simd")->Arg(0)->Arg(1)->Unit(benchmark::kMicrosecond);

// ---- Voting -------------------------------------------------------------------------------------------------------

// Images of simulated words: frequencies fall as in Zipf's law, as those of a real vocabulary do.
std::vector<AppearanceVector> zipf_images(int images, int features, std::uint64_t seed) {
  constexpr int kWords = 50000;
  std::vector<double> cumulative(kWords);
  double sum = 0;
  for (int w = 0; w < kWords; ++w) cumulative[w] = sum += 1 / std::pow(w + 20.0, 0.7);
  std::mt19937_64 random(seed);
  std::vector<AppearanceVector> all;
  for (int i = 0; i < images; ++i) {
    AppearanceVector v{.width_px = 320, .height_px = 240, .appearances = {}};
    for (int f = 0; f < features; ++f) {
      const double u = static_cast<double>(random() >> 11) * 0x1p-53 * sum;
      const auto word = std::ranges::lower_bound(cumulative, u) - cumulative.begin();
      v.appearances.push_back({WordId{static_cast<std::uint32_t>(word)}, 0, 0, 4, 0});
    }
    std::ranges::sort(v.appearances);
    all.push_back(std::move(v));
  }
  return all;
}

void BM_Vote(benchmark::State& state) {
  InvertedIndex index;
  for (const AppearanceVector& v : zipf_images(static_cast<int>(state.range(0)), 400, 1)) index.add(v);
  const auto queries = zipf_images(50, 400, 2);
  const auto rule = state.range(1) != 0 ? VoteRule::kProduct : VoteRule::kMin;
  std::size_t q = 0;
  for (auto _ : state) benchmark::DoNotOptimize(vote(queries[q++ % queries.size()], index, rule, 10));
  state.SetLabel(state.range(1) != 0 ? "product" : "min");
}
BENCHMARK(BM_Vote)->ArgsProduct({{500, 1356, 20000}, {0, 1}})->Unit(benchmark::kMicrosecond);

void BM_VoteAllOfTwoMaps(benchmark::State& state) {
  InvertedIndex index;
  for (const AppearanceVector& v : zipf_images(1356, 400, 1)) index.add(v);
  const auto queries = zipf_images(610, 400, 2);
  for (auto _ : state) {
    for (const AppearanceVector& query : queries) benchmark::DoNotOptimize(vote(query, index, VoteRule::kMin, 10));
  }
}
BENCHMARK(BM_VoteAllOfTwoMaps)->Unit(benchmark::kMillisecond);

// ---- Verification -------------------------------------------------------------------------------------------------

struct Pair {
  const Photograph* a;
  const Photograph* b;
};

// The pairs of two folders with so many votes; empty when the photographs are not here.
std::vector<Pair> candidates(const std::vector<std::string>& of_a, const std::vector<std::string>& of_b,
                             std::uint32_t min_votes) {
  std::vector<Pair> pairs;
  for (const std::string& p : of_a) {
    for (const std::string& q : of_b) {
      for (const Photograph& a : photographs(p)) {
        for (const Photograph& b : photographs(q)) {
          if (pair_votes(a.appearances, b.appearances, VoteRule::kMin) >= min_votes) pairs.push_back({&a, &b});
        }
      }
    }
  }
  return pairs;
}

const std::vector<std::string> kCorridor{"corridor-two-laps/lap-1", "corridor-two-laps/lap-2"};
const std::vector<std::string> kOffice{"office-two-runs/reference", "office-two-runs/live"};
const std::vector<std::string> kShop{"places-two-visits/magasin/A", "places-two-visits/magasin/B"};
const std::vector<std::string> kStudio{"places-two-visits/studio/A", "places-two-visits/studio/B"};

double median(std::vector<double>& v) {
  if (v.empty()) return 0;
  const auto middle = v.begin() + static_cast<std::ptrdiff_t>(v.size() / 2);
  std::ranges::nth_element(v, middle);
  return *middle;
}

// One pass over all candidates of a merge; medians and means by verdict.
void verify_candidates(benchmark::State& state, const std::vector<Pair>& pairs) {
  if (pairs.empty()) {
    state.SkipWithError("photographs are not here (MAPWELD_PHOTOS)");
    return;
  }
  const EpipolarVerifier verifier;
  std::vector<double> accepted_us, rejected_us;
  for (auto _ : state) {
    for (const Pair& p : pairs) {
      const auto start = std::chrono::steady_clock::now();
      const Verification v = verifier.verify(p.a->appearances, p.b->appearances);
      const std::chrono::duration<double, std::micro> took = std::chrono::steady_clock::now() - start;
      (v.accepted ? accepted_us : rejected_us).push_back(took.count());
    }
  }
  std::vector<double> all = accepted_us;
  all.insert(all.end(), rejected_us.begin(), rejected_us.end());
  double total = 0;
  for (const double t : all) total += t;
  state.counters["candidates"] = static_cast<double>(pairs.size());
  state.counters["accepted"] = static_cast<double>(accepted_us.size()) / static_cast<double>(state.iterations());
  state.counters["mean_us"] = total / static_cast<double>(all.size());
  state.counters["median_us"] = median(all);
  state.counters["accepted_us"] = median(accepted_us);
  state.counters["rejected_us"] = median(rejected_us);
}
void BM_VerifyCorridor(benchmark::State& state) {
  verify_candidates(state, candidates({kCorridor[0]}, {kCorridor[1]}, 10));
}
BENCHMARK(BM_VerifyCorridor)->Unit(benchmark::kMillisecond);
void BM_VerifyOffice(benchmark::State& state) { verify_candidates(state, candidates({kOffice[0]}, {kOffice[1]}, 10)); }
BENCHMARK(BM_VerifyOffice)->Unit(benchmark::kMillisecond);
void BM_VerifyWrongPairs(benchmark::State& state) { verify_candidates(state, candidates(kOffice, kCorridor, 8)); }
BENCHMARK(BM_VerifyWrongPairs)->Unit(benchmark::kMillisecond);

void BM_VerifyMadeScene(benchmark::State& state) {
  const auto scene = test::make_scene(
      {.points = static_cast<int>(state.range(0)), .outliers = static_cast<int>(state.range(1)), .clutter = 200});
  const EpipolarVerifier verifier;
  for (auto _ : state) benchmark::DoNotOptimize(verifier.verify(scene.a, scene.b));
}
BENCHMARK(BM_VerifyMadeScene)
    ->ArgNames({"inliers", "outliers"})
    ->Args({20, 10})
    ->Args({60, 30})
    ->Args({150, 100})
    ->Args({0, 30})
    ->Args({0, 200})
    ->Unit(benchmark::kMicrosecond);

// The estimator alone beside OpenCV's USAC family, on the matches of a made scene, without the similarity vote before
// it; inliers counted alike.
void BM_FundamentalMatrix(benchmark::State& state) {
  const auto scene = test::make_scene(
      {.points = static_cast<int>(state.range(1)), .outliers = static_cast<int>(state.range(2)), .noise_px = 0.4});
  const Correspondences c = make_correspondences(scene.a, scene.b, word_matches(scene.a, scene.b, 1, 1000));
  std::vector<cv::Point2d> pa, pb;
  for (std::size_t i = 0; i < c.size(); ++i) {
    pa.emplace_back(400 * c.xa[i], 400 * c.ya[i]);
    pb.emplace_back(400 * c.xb[i], 400 * c.yb[i]);
  }
  Matrix3 f{};
  std::uint64_t seed = 0;
  double inliers = 0;
  std::vector<float> d2;
  for (auto _ : state) {
    if (state.range(0) == 0) {
      f = robust_fundamental(c, ++seed, {.max_samples = 1000}).f;
    } else {
      const cv::Mat m =
          cv::findFundamentalMat(pa, pb, state.range(0) == 1 ? cv::USAC_FAST : cv::USAC_ACCURATE, 2.0, 0.99, 1000);
      for (int k = 0; k < 9 && !m.empty(); ++k) {
        f[k] = m.at<double>(k / 3, k % 3) * (k / 3 < 2 ? 400 : 1) * (k % 3 < 2 ? 400 : 1);
      }
    }
    epipolar_distances2(c, f, d2);
    inliers += static_cast<double>(std::ranges::count_if(d2, [](float d) { return d <= 0.005f * 0.005f; }));
  }
  state.counters["inliers"] = inliers / static_cast<double>(state.iterations());
  state.SetLabel(state.range(0) == 0 ? "ours" : state.range(0) == 1 ? "USAC_FAST" : "USAC_ACCURATE");
}
BENCHMARK(BM_FundamentalMatrix)
    ->ArgNames({"engine", "inliers", "outliers"})
    ->ArgsProduct({{0, 1, 2}, {60}, {10, 30, 60}})
    ->Unit(benchmark::kMicrosecond);

// ---- Localization -------------------------------------------------------------------------------------------------

void BM_LocalizeInOffice(benchmark::State& state) {
  const auto& live = photographs(kOffice[1]);
  const auto& reference = photographs(kOffice[0]);
  if (live.empty() || reference.empty()) {
    state.SkipWithError("photographs are not here (MAPWELD_PHOTOS)");
    return;
  }
  const auto verifier = make_verifier();
  const MapParameters parameters;
  test::SceneMap map;
  for (const Photograph& p : live) {
    const MappingDecision decision = decide(p.appearances, map, *verifier, parameters);
    std::vector<VertexId> neighbours;
    for (const LocalizationMatch& edge : decision.edges) neighbours.push_back(edge.vertex);
    map.add(decision.image, neighbours);
  }
  std::vector<double> localized;
  std::vector<double> verified;
  double ambiguous = 0;
  std::size_t q = 0;
  for (auto _ : state) {
    const Localization l = localize(reference[q++ % reference.size()].appearances, map, *verifier, parameters);
    localized.push_back(l.status == LocalizationStatus::kLocalized ? 1 : 0);
    verified.push_back(l.funnel.verified);
    ambiguous += l.status == LocalizationStatus::kAmbiguous ? 1 : 0;
  }
  const double n = static_cast<double>(localized.size());
  const auto mean = [n](const std::vector<double>& v) {
    double sum = 0;
    for (const double x : v) sum += x;
    return sum / n;
  };
  state.counters["localized"] = mean(localized);
  state.counters["ambiguous"] = ambiguous / n;
  state.counters["verified"] = mean(verified);
}
BENCHMARK(BM_LocalizeInOffice)->Unit(benchmark::kMillisecond);

// ---- Verdicts -----------------------------------------------------------------------------------------------------

// 100,000 pairs with 12 to 300 common words at unrelated places.
void BM_Chance(benchmark::State& state) {
  const EpipolarVerifier verifier;
  const auto layout = static_cast<test::Layout>(state.range(0));
  std::uint64_t seed = 0;
  double accepted = 0;
  double lowest = 300;
  double most_inliers = 0;
  for (auto _ : state) {
    state.PauseTiming();
    const auto [a, b] = test::make_chance_pair({.seed = ++seed,
                                                .matches = 12 + static_cast<int>((seed * 7919) % 289),
                                                .layout = layout,
                                                .equal_frames = state.range(1) != 0});
    state.ResumeTiming();
    const Verification v = verifier.verify(a, b);
    accepted += v.accepted ? 1 : 0;
    lowest = std::min(lowest, v.log10_false_alarms);
    most_inliers = std::max(most_inliers, static_cast<double>(v.inliers));
  }
  state.counters["accepted"] = accepted;
  state.counters["lowest_log10_false_alarms"] = lowest;
  state.counters["most_inliers"] = most_inliers;
}
BENCHMARK(BM_Chance)
    ->ArgNames({"layout", "equal_frames"})
    ->ArgsProduct({{0, 1, 2, 3}, {0, 1}})
    ->Iterations(100000)
    ->Unit(benchmark::kMicrosecond);

void report_verdicts(benchmark::State& state, const std::vector<Pair>& pairs, auto is_right) {
  if (pairs.empty()) {
    state.SkipWithError("photographs are not here (MAPWELD_PHOTOS)");
    return;
  }
  const EpipolarVerifier verifier;
  for (auto _ : state) {
    double accepted = 0, right = 0, right_accepted = 0, lowest_wrong = 300, most_wrong = 0;
    for (const Pair& p : pairs) {
      const Verification v = verifier.verify(p.a->appearances, p.b->appearances);
      const bool truth = is_right(*p.a, *p.b);
      accepted += v.accepted ? 1 : 0;
      right += truth ? 1 : 0;
      right_accepted += truth && v.accepted ? 1 : 0;
      if (!truth) {
        lowest_wrong = std::min(lowest_wrong, v.log10_false_alarms);
        most_wrong = std::max(most_wrong, static_cast<double>(v.inliers));
      }
    }
    state.counters["pairs"] = static_cast<double>(pairs.size());
    state.counters["accepted"] = accepted;
    state.counters["right"] = right;
    state.counters["right_accepted"] = right_accepted;
    state.counters["others_lowest_log10_false_alarms"] = lowest_wrong;
    state.counters["others_most_inliers"] = most_wrong;
  }
}
const auto kNever = [](const Photograph&, const Photograph&) { return false; };
void BM_PlacesCorridorOffice(benchmark::State& state) {
  report_verdicts(state, candidates(kCorridor, kOffice, 0), kNever);
}
BENCHMARK(BM_PlacesCorridorOffice)->Iterations(1)->Unit(benchmark::kMillisecond);
void BM_PlacesShopStudio(benchmark::State& state) { report_verdicts(state, candidates(kShop, kStudio, 0), kNever); }
BENCHMARK(BM_PlacesShopStudio)->Iterations(1)->Unit(benchmark::kMillisecond);
void BM_PlacesCorridorShopStudio(benchmark::State& state) {
  std::vector<std::string> places = kShop;
  places.insert(places.end(), kStudio.begin(), kStudio.end());
  report_verdicts(state, candidates(kCorridor, places, 0), kNever);
}
BENCHMARK(BM_PlacesCorridorShopStudio)->Iterations(1)->Unit(benchmark::kMillisecond);
void BM_PlacesOfficeShopStudio(benchmark::State& state) {
  std::vector<std::string> places = kShop;
  places.insert(places.end(), kStudio.begin(), kStudio.end());
  report_verdicts(state, candidates(kOffice, places, 0), kNever);
}
BENCHMARK(BM_PlacesOfficeShopStudio)->Iterations(1)->Unit(benchmark::kMillisecond);

const auto kSameName = [](const Photograph& a, const Photograph& b) { return a.number == b.number; };
void BM_PlacesShopVisits(benchmark::State& state) {
  report_verdicts(state, candidates({kShop[0]}, {kShop[1]}, 0), kSameName);
}
BENCHMARK(BM_PlacesShopVisits)->Iterations(1)->Unit(benchmark::kMillisecond);
void BM_PlacesStudioVisits(benchmark::State& state) {
  report_verdicts(state, candidates({kStudio[0]}, {kStudio[1]}, 0), kSameName);
}
BENCHMARK(BM_PlacesStudioVisits)->Iterations(1)->Unit(benchmark::kMillisecond);

// The truth of the corridor, widened by so many images on either lap.
void BM_CorridorLaps(benchmark::State& state) {
  const auto truth = test::corridor_same_place();
  const int wider = static_cast<int>(state.range(0));
  report_verdicts(state, candidates({kCorridor[0]}, {kCorridor[1]}, 0), [&](const Photograph& a, const Photograph& b) {
    return std::ranges::any_of(truth, [&](const auto& t) {
      return std::abs(t.first - a.number) <= wider && std::abs(t.second - b.number) <= wider;
    });
  });
}
BENCHMARK(BM_CorridorLaps)->ArgName("wider")->Arg(0)->Arg(1)->Arg(2)->Iterations(1)->Unit(benchmark::kMillisecond);
void BM_OfficeRuns(benchmark::State& state) {
  report_verdicts(state, candidates({kOffice[0]}, {kOffice[1]}, 0), kNever);
}
BENCHMARK(BM_OfficeRuns)->Iterations(1)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace mapweld
