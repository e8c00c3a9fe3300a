// Keeps the inverted index at rest up to date, in the background.
#pragma once

#include <condition_variable>
#include <mutex>
#include <thread>

#include "schema/store.h"

namespace mapweld::server {

// Writes the segments that are due (schema/segments/segment_store.h) whenever something was stored since the last look.
class SegmentWriter {
 public:
  // `store` must outlive this.
  explicit SegmentWriter(Store& store);
  ~SegmentWriter();  // stop()
  SegmentWriter(const SegmentWriter&) = delete;
  SegmentWriter& operator=(const SegmentWriter&) = delete;

  // Waits for the segment that is being written. Idempotent.
  void stop();

 private:
  void work();

  Store& store_;
  std::mutex mutex_;
  std::condition_variable wake_;
  bool stopping_ = false;
  std::thread thread_;
};

}  // namespace mapweld::server
