#include "server/services/worker_pool.h"

#include <atomic>
#include <chrono>

#include <gtest/gtest.h>

namespace mapweld::server {
namespace {

using namespace std::chrono_literals;

TEST(WorkerPool, RunsEveryTaskAndHandsBackItsResult) {
  WorkerPool pool(4);
  WorkerPool::Lane lane(pool);
  std::vector<std::future<int>> results;
  for (int i = 0; i < 1000; ++i) results.push_back(lane.submit([i] { return i * i; }));
  for (int i = 0; i < 1000; ++i) EXPECT_EQ(results[static_cast<std::size_t>(i)].get(), i * i);
}

TEST(WorkerPool, AnExceptionIsTheTasksResult) {
  WorkerPool pool(1);
  WorkerPool::Lane lane(pool);
  auto failed = lane.submit([]() -> int { throw std::runtime_error("no"); });
  EXPECT_THROW(failed.get(), std::runtime_error);
  EXPECT_EQ(lane.submit([] { return 7; }).get(), 7);
}

TEST(WorkerPool, ASingleTaskDoesNotWaitBehindALongLane) {
  WorkerPool pool(1);
  std::atomic<int> done{0};
  std::promise<void> gate;
  auto open = gate.get_future().share();
  WorkerPool::Lane batch(pool);
  for (int i = 0; i < 100; ++i) {
    batch.submit([&done, open] {
      open.wait();
      ++done;
    });
  }
  WorkerPool::Lane single(pool);
  auto answer = single.submit([&done] { return done.load(); });
  gate.set_value();
  EXPECT_LE(answer.get(), 2);
}

TEST(WorkerPool, AClosedLaneForgetsItsTasks) {
  WorkerPool pool(1);
  std::atomic<int> begun{0};
  {
    WorkerPool::Lane lane(pool);
    for (int i = 0; i < 100; ++i) {
      lane.submit([&begun] {
        ++begun;
        std::this_thread::sleep_for(20ms);
      });
    }
    while (begun == 0) std::this_thread::sleep_for(1ms);
  }
  const int at_close = begun;
  EXPECT_LT(at_close, 100);
  std::this_thread::sleep_for(50ms);
  EXPECT_EQ(begun, at_close);
}

TEST(WorkerPool, TellsOnceThatItIsIdle) {
  std::atomic<int> told{0};
  std::promise<void> first;
  WorkerPool pool(3, [&] {
    if (told++ == 0) first.set_value();
  });
  {
    WorkerPool::Lane lane(pool);
    std::vector<std::future<void>> done;
    for (int i = 0; i < 20; ++i) done.push_back(lane.submit([&told] { EXPECT_EQ(told, 0); }));
    for (auto& task : done) task.get();
  }
  EXPECT_EQ(first.get_future().wait_for(60s), std::future_status::ready);
  std::this_thread::sleep_for(50ms);
  EXPECT_EQ(told, 1);
}

}  // namespace
}  // namespace mapweld::server
