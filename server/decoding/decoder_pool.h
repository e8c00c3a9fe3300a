// Decoding in processes of their own, so that a file which breaks a decoder breaks nothing else.
#pragma once

#include <atomic>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "server/decoding/image_decoder.h"

namespace mapweld::server {

namespace decoding {
struct Job;
}

struct DecoderPoolOptions {
  std::string program = "/proc/self/exe";  // started as `program decode-images`
  int processes = 2;                       // images decoded at the same time
  std::size_t max_file_bytes = 64 * 1024 * 1024;
  // For one image. Of 16 megapixels of noise, the most that is taken, a 16-bit PNG of four channels needs 1.6 s, a
  // progressive JPEG 0.9 s, one that is arithmetic-coded 8 s.
  double max_processor_s = 10;
};

// Processes that are started beforehand, each in a sandbox (decoder_process.h), and replaced when they die. A file that
// kills its process, holds it for longer than it may, or needs more memory than it has is an ImageError
// undecodable_image like any other that cannot be read.
class DecoderPool final : public ImageDecoder {
 public:
  // Throws std::system_error when the processes cannot be started.
  explicit DecoderPool(const DecoderPoolOptions& options);
  ~DecoderPool() override;

  DecodedImage decode(std::span<const std::uint8_t> bytes, bool stretch) override;
  std::vector<std::uint8_t> shrink(std::span<const std::uint8_t> bytes, int width_px) override;

  // Processes that died, or were ended, and were replaced.
  std::uint64_t replaced() const { return replaced_; }
  std::vector<int> process_ids() const;  // of those that wait for work

 private:
  class Process;
  class Turn;

  // Has a process work on `file`; `take(process, result)` gives nothing for a result that no honest process gives.
  template <typename Take>
  auto work(std::span<const std::uint8_t> file, const decoding::Job& job, const Take& take);

  const DecoderPoolOptions options_;
  mutable std::mutex mutex_;
  std::condition_variable idle_changed_;
  std::vector<std::unique_ptr<Process>> idle_;  // null: died and could not be replaced yet
  std::atomic<std::uint64_t> replaced_{0};
};

}  // namespace mapweld::server
