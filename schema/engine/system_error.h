// Failures of the operating system as the store's errors.
#pragma once

#include <filesystem>
#include <string>

#include "schema/engine/store_error.h"

namespace mapweld {

// `error` is an errno: kNoSpace, kNoPermission, kNoResources or kIo.
StoreError system_error_of(int error, const std::string& doing);

// Makes what a folder names safe on the disk. Throws the like.
void sync_folder(const std::filesystem::path& folder);

}  // namespace mapweld
