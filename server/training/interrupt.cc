#include "server/training/interrupt.h"

#include <atomic>
#include <csignal>

namespace mapweld {
namespace {

std::atomic<bool> flag{false};
static_assert(std::atomic<bool>::is_always_lock_free, "a signal handler sets it");

void on_signal(int) { flag = true; }

void install(void (*handler)(int), int flags) {
  struct sigaction action {};
  action.sa_handler = handler;
  action.sa_flags = flags;
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
}

}  // namespace

InterruptFlag::InterruptFlag() {
  flag = false;
  install(on_signal, static_cast<int>(SA_RESETHAND) | SA_RESTART);
}
InterruptFlag::~InterruptFlag() { install(SIG_DFL, 0); }
bool InterruptFlag::raised() { return flag; }

}  // namespace mapweld
