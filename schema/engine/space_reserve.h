// Space on the disk that is kept for deleting.
//
// Deleting rows from a database writes before it frees: on a full disk nothing could be deleted, and what fills the
// disk would stay for ever. A file of some megabytes beside the database is given back then, and made again when there
// is room.
#pragma once

#include <cstdint>
#include <filesystem>

namespace mapweld {

// Belongs to one thread at a time. Never throws: without a reserve everything works but deleting on a full disk.
class SpaceReserve {
 public:
  // `bytes` 0: none is kept. Nothing happens yet.
  SpaceReserve(std::filesystem::path file, std::uint64_t bytes);

  // Takes the space, unless that would leave less than eight times as much.
  void restore() noexcept;
  // Gives the space back when less than that is left on the disk.
  void release_when_short() noexcept;

  bool stands() const { return stands_; }

 private:
  std::filesystem::path file_;
  std::uint64_t bytes_;
  bool stands_ = false;
};

}  // namespace mapweld
