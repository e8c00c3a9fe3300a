// Merge jobs over the stored toy maps "a" and "b": what tests of jobs do again and again.
#pragma once

#include <chrono>
#include <memory>
#include <string>
#include <thread>

#include <gtest/gtest.h>

#include "server/jobs/merge_jobs.h"
#include "tests/server/jobs/stored_toy_maps.h"

namespace mapweld::server {

class JobsOnToyMaps : public ::testing::Test {
 protected:
  static constexpr std::chrono::seconds kLong{60};

  void SetUp() override {
    test::store_toy_maps(store_, world_);
    open();
  }
  void open() {
    MergeJobOptions options = test::job_options(verifier_);
    options.checkpoint_interval_s = 0.01;
    jobs_ = std::make_unique<MergeJobs>(store_, options);
    jobs_->start();
  }
  std::int64_t submit(const MergeBudget& budget = {}, const std::string& name = "ab") {
    MergeRequest request = test::request_of(world_, name);
    request.budget = budget;
    return jobs_->submit(request).id;
  }
  MergeStatus wait(std::int64_t id) { return jobs_->wait(id, kLong); }
  // Waits until a running job has made some verifications.
  void meet(std::int64_t id, std::uint64_t verifications) {
    for (;;) {
      const MergeStatus s = jobs_->get(id);
      if (s.state != JobState::kQueued && (s.state != JobState::kRunning || s.candidates.verified >= verifications)) {
        return;
      }
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
  }
  void expect_uninterrupted(std::int64_t id) { EXPECT_EQ(test::stored_state(store_, id), test::uninterrupted(world_)); }
  template <typename Call>
  void expect_code(const std::string& code, const Call& call) {
    try {
      call();
      ADD_FAILURE() << "not refused: " << code;
    } catch (const MergeJobError& error) {
      EXPECT_EQ(error.code(), code) << error.what();
    } catch (const contract::ContractError& error) {
      EXPECT_EQ(error.code().word(), code) << error.what();
    }
  }
  static MergeBudget seconds(double n) {
    MergeBudget budget;
    budget.seconds = n;
    return budget;
  }
  static MergeBudget verifications(std::uint64_t n) {
    MergeBudget budget;
    budget.verifications = n;
    return budget;
  }
  static MergeBudget edges(std::uint64_t n) {
    MergeBudget budget;
    budget.edges = n;
    return budget;
  }

  test::ToyWorld world_ = test::toy_world(19);
  std::shared_ptr<test::SlowVerifier> verifier_ =
      std::make_shared<test::SlowVerifier>(world_.accept_share, std::chrono::microseconds(500));
  test::TempStore store_;
  std::unique_ptr<MergeJobs> jobs_;
};

}  // namespace mapweld::server
