// A file system for SQLite from which the power can be cut.
#pragma once

#include <cstdint>
#include <functional>

namespace mapweld::test {

// While it lives, every connection that is opened goes through it. What is written stands apart from what is synced: at
// a cut, each sector of 512 bytes holds what was synced last or any of the later writes, some only half. A file whose
// making or deleting was not synced may be there or not. At most one at a time; one thread.
class PowerCutVfs {
 public:
  using Below = std::function<std::uint64_t(std::uint64_t)>;  // a random number below another

  explicit PowerCutVfs(Below below);
  ~PowerCutVfs();
  PowerCutVfs(const PowerCutVfs&) = delete;

  // The n-th call from now on that changes something, from 1, fails, and every call after it.
  void cut_at(std::uint64_t n);
  bool is_off() const;
  // The next sync fails, and nothing but it.
  void fail_next_sync();
  // Puts every file into a state in which the cut may have left it, and the power on again. No connection may be open.
  void restore();
};

}  // namespace mapweld::test
