// Where files wait on their way in or out; they have no name any more when they have arrived.
#pragma once

#include <filesystem>

namespace mapweld::server {

class TransitFolder {
 public:
  // In the data folder, emptied: what a server that stopped was being sent is of no use to anybody. `elsewhere`: a
  // folder of its own among the system's temporary files, removed with this. Throws StoreError, std::system_error.
  TransitFolder(const std::filesystem::path& data_folder, bool elsewhere);
  ~TransitFolder();
  TransitFolder(const TransitFolder&) = delete;
  TransitFolder& operator=(const TransitFolder&) = delete;

  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
  const bool elsewhere_;
};

}  // namespace mapweld::server
