#include "server/commands/progress_bar.h"

#include <algorithm>
#include <cstdio>

#include <unistd.h>

namespace mapweld::server {

ProgressBar::ProgressBar() : is_terminal_(isatty(STDERR_FILENO) != 0) {}

void ProgressBar::show(const std::string& stage, std::uint64_t done, std::uint64_t total) {
  constexpr std::size_t kWidth = 30;
  const auto now = std::chrono::steady_clock::now();
  if (stage != stage_) {
    end();
    stage_ = stage;
  } else if (done < total &&
             now - shown_ < (is_terminal_ ? std::chrono::milliseconds(100) : std::chrono::seconds(10))) {
    return;
  }
  if (!is_terminal_ && done == total && total > 0 && stage == stage_ && shown_ != decltype(shown_){}) {
    if (now - shown_ < std::chrono::milliseconds(100)) return;
  }
  shown_ = now;
  const double share = total == 0 ? 1 : std::min(1.0, static_cast<double>(done) / static_cast<double>(total));
  const auto filled = static_cast<std::size_t>(share * kWidth);
  const std::string bar = std::string(filled, '#') + std::string(kWidth - filled, '.');
  std::fprintf(stderr, is_terminal_ ? "\r[%s] %3.0f %%  %s: %llu of %llu\033[K" : "[%s] %3.0f %%  %s: %llu of %llu\n",
               bar.c_str(), 100 * share, stage.c_str(), static_cast<unsigned long long>(done),
               static_cast<unsigned long long>(total));
}

void ProgressBar::end() {
  if (is_terminal_ && !stage_.empty()) std::fputc('\n', stderr);
  stage_.clear();
}

}  // namespace mapweld::server
