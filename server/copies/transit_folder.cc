#include "server/copies/transit_folder.h"

#include <cerrno>
#include <cstdlib>
#include <string>
#include <system_error>

#include "schema/engine/data_folder.h"

namespace mapweld::server {

TransitFolder::TransitFolder(const std::filesystem::path& data_folder, bool elsewhere) : elsewhere_(elsewhere) {
  if (elsewhere) {
    std::string name = (std::filesystem::temp_directory_path() / "mapweld-XXXXXX").string();
    if (::mkdtemp(name.data()) == nullptr) throw std::system_error(errno, std::generic_category(), name);
    path_ = name;
  } else {
    path_ = data_folder / "transit";
    std::filesystem::remove_all(path_);
    make_data_folder(path_);
  }
}

TransitFolder::~TransitFolder() {
  std::error_code none;
  if (elsewhere_) std::filesystem::remove_all(path_, none);
}

}  // namespace mapweld::server
