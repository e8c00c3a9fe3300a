#include "schema/engine/free_space.h"

#include <system_error>

namespace mapweld {

std::uint64_t available_bytes(const std::filesystem::path& folder) {
  std::error_code error;
  const std::filesystem::space_info space = std::filesystem::space(folder, error);
  return error ? 0 : space.available;
}

}  // namespace mapweld
