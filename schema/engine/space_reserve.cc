#include "schema/engine/space_reserve.h"

#include <system_error>
#include <utility>

#include <fcntl.h>
#include <unistd.h>

#include "schema/engine/free_space.h"

namespace mapweld {
namespace {

constexpr std::uint64_t kLeaveTimes = 8;

}  // namespace

SpaceReserve::SpaceReserve(std::filesystem::path file, std::uint64_t bytes) : file_(std::move(file)), bytes_(bytes) {
  std::error_code error;
  stands_ = bytes_ > 0 && std::filesystem::file_size(file_, error) == bytes_ && !error;
}

void SpaceReserve::restore() noexcept {
  if (stands_ || bytes_ == 0 || available_bytes(file_.parent_path()) < kLeaveTimes * bytes_) return;
  const int descriptor = ::open(file_.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0600);
  if (descriptor < 0) return;
  stands_ = ::posix_fallocate(descriptor, 0, static_cast<off_t>(bytes_)) == 0;
  ::close(descriptor);
  if (!stands_) ::unlink(file_.c_str());
}

void SpaceReserve::release_when_short() noexcept {
  if (!stands_ || available_bytes(file_.parent_path()) >= bytes_) return;
  ::unlink(file_.c_str());
  stands_ = false;
}

}  // namespace mapweld
