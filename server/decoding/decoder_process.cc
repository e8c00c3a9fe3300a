#include "server/decoding/decoder_process.h"

#include <algorithm>
#include <cstdio>
#include <exception>
#include <new>
#include <span>
#include <vector>

#include <opencv2/core.hpp>
#include <opencv2/core/utility.hpp>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include "core/errors.h"
#include "core/feature/allocation.h"
#include "core/feature/shrink.h"
#include "server/decoding/decoder_protocol.h"

namespace mapweld::server {
namespace {

// Twice what 16 megapixels of four 16-bit channels need, interlaced: 364 MB.
constexpr std::size_t kMaxMemoryBytes = std::size_t{768} << 20;

void copy_out(const cv::Mat& pixels, std::uint8_t* to) {
  const cv::Mat target(pixels.rows, pixels.cols, CV_8UC1, to);
  pixels.copyTo(target);
}

void decode(std::span<const std::uint8_t> file, bool stretch, std::uint8_t* to, decoding::Result& result) {
  const DecodedImage image = decode_image(file, {.stretch = stretch});
  result.png = image.format == ImageHeader::Format::kPng;
  result.width_px = image.grey.cols;
  result.height_px = image.grey.rows;
  copy_out(image.grey, to);
  if (!image.used.empty()) {
    result.has_used = 1;
    copy_out(image.used, to + image.grey.total());
  }
}

void shrink(std::span<const std::uint8_t> file, int width_px, std::uint8_t* to, decoding::Result& result) {
  const std::vector<std::uint8_t> smaller = shrink_image(file, width_px);
  if (smaller.size() > decoding::kMaxResultBytes) throw std::bad_alloc();
  std::copy(smaller.begin(), smaller.end(), to);
  result.shrunk_bytes = smaller.size();
}

decoding::Result work(const decoding::Job& job, std::uint8_t* memory) {
  decoding::Result result;
  const std::span<const std::uint8_t> file(memory, job.file_bytes);
  std::uint8_t* const to = memory + job.max_file_bytes;
  try {
    if (job.shrink_to_px > 0) {
      shrink(file, job.shrink_to_px, to, result);
    } else {
      decode(file, job.stretch != 0, to, result);
    }
  } catch (const ImageError& error) {
    result.outcome = decoding::Outcome::kRefused;
    decoding::put(result.code, error.code());
    decoding::put(result.detail, error.what());
  } catch (const std::bad_alloc&) {
    result.outcome = decoding::Outcome::kOutOfMemory;
  } catch (const cv::Exception&) {  // its way of saying that there is no memory
    result.outcome = decoding::Outcome::kOutOfMemory;
  }
  return result;
}

}  // namespace

int run_decoder_process() {
  try {
    keep_freed_memory();
    cv::setNumThreads(0);
    struct stat size {};
    if (::fstat(decoding::kMemory, &size) != 0) throw std::runtime_error("started without its shared memory");
    void* const memory = ::mmap(nullptr, static_cast<std::size_t>(size.st_size), PROT_READ | PROT_WRITE, MAP_SHARED,
                                decoding::kMemory, 0);
    if (memory == MAP_FAILED) throw std::runtime_error("cannot map its shared memory");
    enter_sandbox(kMaxMemoryBytes);
    decoding::Job job;
    while (::read(decoding::kSocket, &job, sizeof job) == sizeof job) {
      const decoding::Result result = work(job, static_cast<std::uint8_t*>(memory));
      const bool was_large = result.width_px > 0 && std::int64_t{result.width_px} * result.height_px > (1 << 20);
      if (was_large || job.shrink_to_px > 0) give_back_freed_memory();
      if (::write(decoding::kSocket, &result, sizeof result) != sizeof result) break;
    }
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "mapweld-server decode-images: %s\n", error.what());
    return 1;
  }
}

}  // namespace mapweld::server
