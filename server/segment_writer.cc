#include "server/segment_writer.h"

#include <chrono>
#include <cstdint>
#include <exception>

#include <spdlog/spdlog.h>

#include "schema/segments/segment_store.h"

namespace mapweld::server {
namespace {

constexpr std::chrono::seconds kInterval{2};

}  // namespace

SegmentWriter::SegmentWriter(Store& store) : store_(store), thread_([this] { work(); }) {}

SegmentWriter::~SegmentWriter() { stop(); }

void SegmentWriter::stop() {
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
  }
  wake_.notify_all();
  if (thread_.joinable()) thread_.join();
}

void SegmentWriter::work() {
  std::uint64_t seen_commits = UINT64_MAX;  // so that the first look is not skipped
  std::unique_lock lock(mutex_);
  while (!wake_.wait_for(lock, kInterval, [this] { return stopping_; })) {
    lock.unlock();
    try {
      const std::uint64_t commits = store_.statistics().commits;
      if (commits != seen_commits) {
        const SegmentStatistics written = write_due_segments(store_);
        if (written.written > 0) {
          spdlog::debug("index: {} segments written, {} merged into longer ones", written.written, written.merged);
        }
        seen_commits = commits;
      }
    } catch (const std::exception& error) {
      // Nothing is lost: appearances answer until segments are written.
      spdlog::warn("index: segments could not be written: {}", error.what());
    }
    lock.lock();
  }
}

}  // namespace mapweld::server
