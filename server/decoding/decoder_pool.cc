#include "server/decoding/decoder_pool.h"

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <ctime>
#include <optional>
#include <stdexcept>
#include <string_view>
#include <system_error>
#include <utility>

#include <fcntl.h>
#include <poll.h>
#include <spawn.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include "core/errors.h"
#include "server/decoding/decoder_protocol.h"

namespace mapweld::server {
namespace {

using decoding::Job;
using decoding::Outcome;
using decoding::Result;

constexpr int kPollSliceMs = 100;                         // how often the processor time of a job is looked at
constexpr int kMaxSlices = 1200;                          // a process that stands still is not waited for for ever
constexpr std::size_t kKeptBytes = std::size_t{8} << 20;  // shared memory that a process keeps from job to job

[[noreturn]] void fail(const char* what) { throw std::system_error(errno, std::generic_category(), what); }

class Descriptor {
 public:
  explicit Descriptor(int fd = -1) : fd_(fd) {}
  ~Descriptor() {
    if (fd_ >= 0) ::close(fd_);
  }
  Descriptor(Descriptor&& other) noexcept : fd_(std::exchange(other.fd_, -1)) {}
  Descriptor& operator=(Descriptor&&) = delete;
  int get() const { return fd_; }

 private:
  int fd_;
};

// What the loader and sanitizers are told; whatever else is there is no business of a process that strangers may enter.
std::vector<char*> little_environment() {
  std::vector<char*> few;
  for (char** variable = environ; *variable != nullptr; ++variable) {
    const std::string_view text(*variable);
    if (text.starts_with("LD_") || text.substr(0, text.find('=')).ends_with("SAN_OPTIONS")) few.push_back(*variable);
  }
  few.push_back(nullptr);
  return few;
}

double processor_s(pid_t process) {
  clockid_t clock{};
  timespec time{};
  if (::clock_getcpuclockid(process, &clock) != 0 || ::clock_gettime(clock, &time) != 0) return 0;
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

}  // namespace

class DecoderPool::Process {
 public:
  explicit Process(const DecoderPoolOptions& options)
      : options_(options), bytes_(decoding::memory_bytes(options.max_file_bytes)), file_(make_memory(bytes_)) {
    memory_ = static_cast<std::uint8_t*>(
        ::mmap(nullptr, bytes_, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_NORESERVE, file_.get(), 0));
    if (memory_ == MAP_FAILED) fail("mmap");
    try {
      start();
    } catch (...) {
      ::munmap(memory_, bytes_);
      throw;
    }
  }

  ~Process() {
    ::kill(process_, SIGKILL);
    ::waitpid(process_, nullptr, 0);
    ::close(socket_);
    ::munmap(memory_, bytes_);
  }
  Process(const Process&) = delete;
  Process& operator=(const Process&) = delete;

  pid_t id() const { return process_; }

  enum class Answer : std::uint8_t { kResult, kGoneBefore, kDied, kTooSlow };
  // kGoneBefore: it was not there to take the job.
  Answer run(std::span<const std::uint8_t> file, Job job, Result& result) {
    std::copy(file.begin(), file.end(), memory_);
    job.file_bytes = file.size();
    job.max_file_bytes = options_.max_file_bytes;
    const double began_s = processor_s(process_);
    if (::send(socket_, &job, sizeof job, MSG_NOSIGNAL) != sizeof job) return Answer::kGoneBefore;
    pollfd reply{socket_, POLLIN, 0};
    for (int slice = 0;; ++slice) {
      const int ready = ::poll(&reply, 1, kPollSliceMs);
      if (ready > 0) break;
      if (ready < 0 && errno != EINTR) return Answer::kDied;
      if (slice == kMaxSlices || processor_s(process_) - began_s > options_.max_processor_s) return Answer::kTooSlow;
    }
    return ::recv(socket_, &result, sizeof result, 0) == sizeof result ? Answer::kResult : Answer::kDied;
  }

  // Both null for a result that no honest process gives.
  std::optional<std::vector<std::uint8_t>> take_file(const Result& result) const {
    if (result.shrunk_bytes > decoding::kMaxResultBytes) return std::nullopt;
    const std::uint8_t* const file = memory_ + options_.max_file_bytes;
    return std::vector<std::uint8_t>(file, file + result.shrunk_bytes);
  }
  std::optional<DecodedImage> take_pixels(const Result& result) const {
    const std::int64_t pixels = std::int64_t{result.width_px} * result.height_px;
    if (result.width_px <= 0 || result.height_px <= 0 || pixels > decoding::kMaxPixels) return std::nullopt;
    std::uint8_t* const grey = memory_ + options_.max_file_bytes;
    DecodedImage image;
    image.format = result.png != 0 ? ImageHeader::Format::kPng : ImageHeader::Format::kJpeg;
    image.grey = cv::Mat(result.height_px, result.width_px, CV_8UC1, grey).clone();
    if (result.has_used != 0) image.used = cv::Mat(result.height_px, result.width_px, CV_8UC1, grey + pixels).clone();
    return image;
  }

  // Gives back what a large file and its pixels took.
  void forget(std::size_t file_bytes, const Result& result) const {
    const std::size_t pixels = 2 * static_cast<std::size_t>(std::max(result.width_px, 0)) *
                               static_cast<std::size_t>(std::max(result.height_px, 0));
    if (file_bytes + pixels + result.shrunk_bytes > kKeptBytes) {
      ::fallocate(file_.get(), FALLOC_FL_PUNCH_HOLE | FALLOC_FL_KEEP_SIZE, 0, static_cast<off_t>(bytes_));
    }
  }

 private:
  static Descriptor make_memory(std::size_t bytes) {
    Descriptor file(::memfd_create("mapweld-decoder", MFD_CLOEXEC));
    if (file.get() < 0 || ::ftruncate(file.get(), static_cast<off_t>(bytes)) != 0) fail("memfd_create");
    return file;
  }

  void start() {
    int ends[2];
    // Messages stay whole, and the end of the other side is told.
    if (::socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, ends) != 0) fail("socketpair");
    const Descriptor theirs(ends[1]);
    socket_ = ends[0];
    // Above those that they become, so that neither overwrites the other.
    const Descriptor socket_copy(::fcntl(theirs.get(), F_DUPFD_CLOEXEC, 10));
    const Descriptor memory_copy(::fcntl(file_.get(), F_DUPFD_CLOEXEC, 10));
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_adddup2(&actions, socket_copy.get(), decoding::kSocket);
    posix_spawn_file_actions_adddup2(&actions, memory_copy.get(), decoding::kMemory);
    posix_spawn_file_actions_addclosefrom_np(&actions, decoding::kMemory + 1);
    posix_spawnattr_t attributes;
    posix_spawnattr_init(&attributes);
    sigset_t none;
    sigemptyset(&none);
    posix_spawnattr_setsigmask(&attributes, &none);
    // A group of its own: Ctrl-C in the terminal is for the server, which ends them when it is done.
    posix_spawnattr_setpgroup(&attributes, 0);
    posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETPGROUP);
    std::string program = options_.program;
    std::string command = "decode-images";
    char* const arguments[] = {program.data(), command.data(), nullptr};
    std::vector<char*> environment = little_environment();
    const int outcome = ::posix_spawn(&process_, program.c_str(), &actions, &attributes, arguments, environment.data());
    posix_spawn_file_actions_destroy(&actions);
    posix_spawnattr_destroy(&attributes);
    if (outcome != 0) {
      ::close(socket_);
      errno = outcome;
      fail("cannot start a process that decodes images");
    }
  }

  const DecoderPoolOptions& options_;
  const std::size_t bytes_;
  const Descriptor file_;
  std::uint8_t* memory_ = nullptr;
  int socket_ = -1;
  pid_t process_ = -1;
};

// A process for one image, replaced behind it when it is spoilt.
class DecoderPool::Turn {
 public:
  explicit Turn(DecoderPool& pool) : pool_(pool) {
    {
      std::unique_lock lock(pool_.mutex_);
      pool_.idle_changed_.wait(lock, [&] { return !pool_.idle_.empty(); });
      process_ = std::move(pool_.idle_.back());
      pool_.idle_.pop_back();
    }
    try {
      if (!process_) process_ = std::make_unique<Process>(pool_.options_);
    } catch (...) {
      give_back();
      throw;
    }
  }
  ~Turn() { give_back(); }
  Turn(const Turn&) = delete;
  Turn& operator=(const Turn&) = delete;

  Process& process() { return *process_; }
  void replace() {
    ++pool_.replaced_;
    process_.reset();
    process_ = std::make_unique<Process>(pool_.options_);
  }

 private:
  void give_back() {
    {
      const std::lock_guard lock(pool_.mutex_);
      pool_.idle_.push_back(std::move(process_));
    }
    pool_.idle_changed_.notify_one();
  }

  DecoderPool& pool_;
  std::unique_ptr<Process> process_;
};

DecoderPool::DecoderPool(const DecoderPoolOptions& options) : options_(options) {
  for (int i = 0; i < std::max(options.processes, 1); ++i) idle_.push_back(std::make_unique<Process>(options_));
}

DecoderPool::~DecoderPool() = default;

std::vector<int> DecoderPool::process_ids() const {
  const std::lock_guard lock(mutex_);
  std::vector<int> ids;
  for (const auto& process : idle_) {
    if (process) ids.push_back(process->id());
  }
  return ids;
}

template <typename Take>
auto DecoderPool::work(std::span<const std::uint8_t> file, const Job& job, const Take& take) {
  if (file.size() > options_.max_file_bytes) throw std::length_error("a file larger than decoders take");
  Turn turn(*this);
  Result result;
  Process::Answer answer = turn.process().run(file, job, result);
  if (answer == Process::Answer::kGoneBefore) {
    turn.replace();
    answer = turn.process().run(file, job, result);
  }
  if (answer == Process::Answer::kResult) {
    auto taken = take(turn.process(), result);
    turn.process().forget(file.size(), result);  // and what was taken is gone from there
    if (result.outcome == Outcome::kRefused) throw ImageError(decoding::get(result.code), decoding::get(result.detail));
    if (result.outcome == Outcome::kOutOfMemory) {
      throw ImageError("undecodable_image", "The image needs more memory than decoding may take.");
    }
    if (taken) return *std::move(taken);
  }
  turn.replace();
  throw ImageError("undecodable_image", answer == Process::Answer::kTooSlow
                                            ? "The image takes longer to decode than an image may."
                                            : "The decoder broke off over this image.");
}

DecodedImage DecoderPool::decode(std::span<const std::uint8_t> bytes, bool stretch) {
  return work(bytes, {.stretch = stretch},
              [](const Process& process, const Result& result) { return process.take_pixels(result); });
}

std::vector<std::uint8_t> DecoderPool::shrink(std::span<const std::uint8_t> bytes, int width_px) {
  return work(bytes, {.shrink_to_px = width_px},
              [](const Process& process, const Result& result) { return process.take_file(result); });
}

}  // namespace mapweld::server
