// Verifying ahead on several threads: the merge is the same.
#include "core/merge/methods/verification_ahead.h"

#include <algorithm>
#include <functional>
#include <memory>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "core/merge/executor.h"
#include "core/merge/make_merger.h"
#include "core/merge/run.h"
#include "tests/core/merge/toy_maps.h"

namespace mapweld {
namespace {

// Four threads, whatever the machine has.
class Threads final : public Executor {
 public:
  std::size_t concurrency() const override { return 4; }
  void run(std::size_t pieces, const std::function<void(std::size_t)>& piece) const override {
    std::vector<std::thread> threads;
    for (std::size_t t = 0; t < 4; ++t) {
      threads.emplace_back([&, t] {
        for (std::size_t i = t; i < pieces; i += 4) piece(i);
      });
    }
    for (std::thread& thread : threads) thread.join();
    batches += 1;
    largest = std::max(largest, pieces);
  }
  mutable std::size_t batches = 0, largest = 0;
};

TEST(VerifyingAhead, ChangesNothing) {
  std::size_t largest = 0;
  for (const std::string_view method : merge_methods()) {
    for (std::uint32_t seed = 0; seed < 12; ++seed) {
      test::ToyWorld world = test::toy_world(seed);
      if (seed % 3 == 0) world = test::toy_world_of_several(seed);
      world.method = method;
      MergeInput input = make_toy_merge(world);
      const auto serial = make_merger(input);
      run(*serial, {});
      const auto threads = std::make_shared<Threads>();
      input.executor = threads;
      const auto parallel = make_merger(input);
      run(*parallel, {}, [&, before = std::uint64_t{0}](const Merger& m) mutable {
        EXPECT_LE(m.state().verifications, before + 1);
        before = m.state().verifications;
      });
      EXPECT_EQ(parallel->state(), serial->state()) << method << " seed " << seed;
      largest = std::max(largest, threads->largest);
    }
  }
  EXPECT_EQ(largest, VerificationAhead::kBatch);
}

TEST(VerifyingAhead, StopsAtExactlySoManyVerifications) {
  test::ToyWorld world = test::toy_world(5);
  MergeInput input = make_toy_merge(world);
  const auto serial = make_merger(input);
  run(*serial, stop_at_verifications(37));
  input.executor = std::make_shared<Threads>();
  const auto parallel = make_merger(input);
  run(*parallel, stop_at_verifications(37));
  EXPECT_EQ(parallel->state().verifications, 37u);
  EXPECT_EQ(parallel->state(), serial->state());
}

}  // namespace
}  // namespace mapweld
