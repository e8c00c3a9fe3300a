#include "server/http/loop/memory_reserve.h"

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdlib>
#include <mutex>
#include <new>

namespace mapweld::server {
namespace {

constexpr std::size_t kPieces = 8;
constexpr std::size_t kPieceBytes = 128 * 1024 - 64;  // below what malloc maps for itself: it stays with the process

std::array<std::atomic<void*>, kPieces> pieces{};
std::mutex turn;  // of those who come and go
int living = 0;
std::new_handler before = nullptr;

bool give_piece() noexcept {
  for (std::atomic<void*>& piece : pieces) {
    if (void* memory = piece.exchange(nullptr)) {
      std::free(memory);
      return true;
    }
  }
  return false;
}

void find_memory() {
  if (!give_piece()) throw std::bad_alloc();
}

}  // namespace

MemoryReserve::MemoryReserve() {
  const std::lock_guard lock(turn);
  if (living++ > 0) return;
  refill();
  before = std::set_new_handler(find_memory);
}

MemoryReserve::~MemoryReserve() {
  const std::lock_guard lock(turn);
  if (--living > 0) return;
  std::set_new_handler(before);
  while (give_piece()) {
  }
}

void MemoryReserve::refill() noexcept {
  for (std::atomic<void*>& piece : pieces) {
    if (piece.load() != nullptr) continue;
    void* memory = std::malloc(kPieceBytes);
    if (memory == nullptr) return;
    void* none = nullptr;
    if (!piece.compare_exchange_strong(none, memory)) std::free(memory);
  }
}

}  // namespace mapweld::server
