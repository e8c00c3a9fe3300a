// Verifying ahead on several threads: the merge is the same.
#include "core/merge/methods/verification_ahead.h"

#include <atomic>
#include <chrono>
#include <cstddef>
#include <memory>
#include <stdexcept>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "core/merge/make_merger.h"
#include "core/merge/run.h"
#include "tests/core/merge/toy_maps.h"
#include "tests/support/thread_executor.h"

namespace mapweld {
namespace {

TEST(VerifyingAhead, ChangesNothing) {
  for (const std::string_view method : merge_methods()) {
    std::size_t tasks = 0;
    for (std::uint32_t seed = 0; seed < 12; ++seed) {
      test::ToyWorld world = test::toy_world(seed);
      if (seed % 3 == 0) world = test::toy_world_of_several(seed);
      world.method = method;
      MergeInput input = make_toy_merge(world);
      const auto serial = make_merger(input);
      run(*serial, {});
      const auto threads = std::make_shared<test::ThreadExecutor>();
      input.executor = threads;
      const auto parallel = make_merger(input);
      run(*parallel, {}, [&, before = std::uint64_t{0}](const Merger& m) mutable {
        EXPECT_LE(m.state().verifications, before + 1);
        before = m.state().verifications;
      });
      EXPECT_EQ(parallel->state(), serial->state()) << method << " seed " << seed;
      tasks += threads->tasks();
    }
    // What degree-min draws next depends on the verdict; toy maps have no stretches to be aligned.
    EXPECT_EQ(tasks > 0, method != "degree-min" && method != "alignment") << method;
  }
}

TEST(VerifyingAhead, StopsAtExactlySoManyVerifications) {
  test::ToyWorld world = test::toy_world(5);
  MergeInput input = make_toy_merge(world);
  const auto serial = make_merger(input);
  run(*serial, stop_at_verifications(37));
  input.executor = std::make_shared<test::ThreadExecutor>();
  const auto parallel = make_merger(input);
  run(*parallel, stop_at_verifications(37));
  EXPECT_EQ(parallel->state().verifications, 37u);
  EXPECT_EQ(parallel->state(), serial->state());
}

// Images that are told apart by their width; one cannot be read at first.
class Widths final : public AppearanceSource {
 public:
  static constexpr std::uint32_t kUnreadable = 7;
  std::shared_ptr<const AppearanceVector> appearances(VertexId vertex) const override {
    if (to_index(vertex) == kUnreadable && is_broken) throw std::runtime_error("cannot be read");
    return std::make_shared<const AppearanceVector>(
        AppearanceVector{.width_px = static_cast<int>(to_index(vertex)), .height_px = 1, .appearances = {}});
  }
  std::atomic<bool> is_broken = true;
};

class Counting final : public PairVerifier {
 public:
  Verification verify(const AppearanceVector& a, const AppearanceVector& b) const override {
    ++verified;
    Verification verdict;
    verdict.inliers = 1000 * a.width_px + b.width_px;
    return verdict;
  }
  std::string version() const override { return "counting"; }
  const VerifierOptions& options() const override { return options_; }
  mutable std::atomic<std::size_t> verified = 0;

 private:
  VerifierOptions options_;
};

TEST(VerifyingAhead, OthersWorkWhileTheCallerDoesNot) {
  const auto images = std::make_shared<Widths>();
  const auto verifier = std::make_shared<Counting>();
  MergeInput input;
  input.appearances = images;
  input.verifier = verifier;
  input.executor = std::make_shared<test::ThreadExecutor>();
  VerificationAhead ahead(input);
  std::vector<Candidate> pairs;
  for (std::uint32_t v = 1; v <= 50; ++v) pairs.push_back({VertexId{0}, VertexId{v}, 0});
  std::size_t taken = 0;
  const auto take = [&] {
    const Candidate& c = pairs[taken];
    const Verification verdict = ahead.take(c.source, c.target, [&](std::size_t most, std::vector<Candidate>& next) {
      for (std::size_t i = taken; i < pairs.size() && next.size() < most; ++i) next.push_back(pairs[i]);
    });
    EXPECT_EQ(verdict.inliers, static_cast<int>(to_index(c.target)));
    ++taken;
  };
  take();
  const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(60);
  while (verifier->verified < 49 && std::chrono::steady_clock::now() < deadline) std::this_thread::yield();
  EXPECT_EQ(verifier->verified, 49u) << "all but the one that cannot be read";
  while (taken + 1 < Widths::kUnreadable) take();
  EXPECT_THROW(take(), std::runtime_error);
  images->is_broken = false;
  while (taken < pairs.size()) take();
  EXPECT_EQ(verifier->verified, 50u) << "each once";
}

}  // namespace
}  // namespace mapweld
