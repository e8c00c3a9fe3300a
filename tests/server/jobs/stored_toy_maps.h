// The small random maps of tests/core/merge, in a store; and what a merge of them must end with.
#pragma once

#include <atomic>
#include <chrono>
#include <memory>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "core/merge/merge_state.h"
#include "schema/store.h"
#include "server/jobs/merge_jobs.h"
#include "tests/core/merge/toy_maps.h"
#include "tests/support/temp_store.h"

namespace mapweld::test {

// Maps "a" and "b" (or as they are named here), "c", ... with the world's members.
void store_toy_maps(Store& store, const ToyWorld& world, const std::string& first = "a",
                    const std::string& second = "b");

// The vertices of these maps that are not stored yet, up to so many in each: maps that grow.
void store_toy_vertices(Store& store, const ToyWorld& world, const std::vector<std::string>& names,
                        const std::vector<std::uint32_t>& counts);

// A request for the merge of the world in core.
server::MergeRequest request_of(const ToyWorld& world, const std::string& name = "ab");

// The state of the whole merge as core makes it, without a store and without interruption.
MergeState uninterrupted(const ToyWorld& world);

// All methods but alignment, whose candidates depend on whole sequences: longer ones may leave a pair out that was
// verified before.
std::vector<std::string_view> methods_with_one_candidate_set();
// A method's name as that of a test: without hyphens.
std::string name_of_test(std::string_view method);

// The state in a job's last checkpoint, its edges from their table.
MergeState stored_state(Store& store, std::int64_t job);

// A verifier whose verdicts take time, so that a job can be met while it runs; and that can be told to fail.
class SlowVerifier final : public PairVerifier {
 public:
  SlowVerifier(double accept_share, std::chrono::microseconds each) : delay(each), verdicts_(accept_share) {}
  Verification verify(const AppearanceVector& a, const AppearanceVector& b) const override {
    if (fails) throw std::runtime_error("the verifier is out of order");
    std::this_thread::sleep_for(delay.load());
    ++calls;
    return verdicts_.verify(a, b);
  }
  std::string version() const override { return verdicts_.version(); }
  const VerifierOptions& options() const override { return verdicts_.options(); }

  std::atomic<std::chrono::microseconds> delay;  // of a verdict
  std::atomic<bool> fails = false;
  mutable std::atomic<std::uint64_t> calls = 0;

 private:
  HashVerifier verdicts_;
};

server::MergeJobOptions job_options(const std::shared_ptr<const PairVerifier>& verifier);

}  // namespace mapweld::test
