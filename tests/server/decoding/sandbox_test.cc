#include <cerrno>
#include <csignal>
#include <new>
#include <vector>

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <unistd.h>

#include "server/decoding/decoder_process.h"

namespace mapweld::server {
namespace {

constexpr std::size_t kMemory = std::size_t{256} << 20;

class SandboxDeathTest : public testing::Test {
 protected:
  void SetUp() override {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
    GTEST_SKIP() << "sanitizers need more system calls";
#endif
    GTEST_FLAG_SET(death_test_style, "threadsafe");
  }
};

// Each in a process of its own, which ends with 0 where all is as it should be.
template <typename Attempt>
[[noreturn]] void confined(Attempt attempt) {
  enter_sandbox(kMemory);
  _exit(attempt());
}

TEST_F(SandboxDeathTest, OpensNothing) {
  EXPECT_EXIT(confined([] { return ::open("/etc/passwd", O_RDONLY) < 0 && errno == EACCES ? 0 : 1; }),
              testing::ExitedWithCode(0), "");
}

TEST_F(SandboxDeathTest, EndsAtAnyOtherCall) {
  EXPECT_EXIT(confined([] { return ::socket(AF_INET, SOCK_STREAM, 0); }), testing::KilledBySignal(SIGSYS), "");
  EXPECT_EXIT(confined([] { return static_cast<int>(::fork()); }), testing::KilledBySignal(SIGSYS), "");
  EXPECT_EXIT(confined([] { return ::kill(::getppid(), 0); }), testing::KilledBySignal(SIGSYS), "");
}

TEST_F(SandboxDeathTest, HasNoMemoryToExecute) {
  EXPECT_EXIT(confined([] {
                ::mmap(nullptr, 4096, PROT_READ | PROT_WRITE | PROT_EXEC, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
                return 0;
              }),
              testing::KilledBySignal(SIGSYS), "");
}

TEST_F(SandboxDeathTest, HoldsSoMuchMemoryAndNoMore) {
  EXPECT_EXIT(confined([] {
                std::vector<char> fits(kMemory / 2, 'x');
                try {
                  std::vector<char> too_much(kMemory, 'x');
                  return 1;
                } catch (const std::bad_alloc&) {
                  return fits.back() == 'x' ? 0 : 2;
                }
              }),
              testing::ExitedWithCode(0), "");
}

}  // namespace
}  // namespace mapweld::server
