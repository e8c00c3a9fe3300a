// How much a disk has left.
#pragma once

#include <cstdint>
#include <filesystem>

namespace mapweld {

// For this user, on the disk that a folder is on; 0 when that cannot be told.
std::uint64_t available_bytes(const std::filesystem::path& folder);

// What a file that a request asks for or brings may take there: half of what is free, so that whoever sends much fills
// no disk.
inline std::uint64_t share_of_free_bytes(const std::filesystem::path& folder) { return available_bytes(folder) / 2; }

}  // namespace mapweld
