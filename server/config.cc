#include "server/config.h"

#include <set>
#include <system_error>
#include <vector>

namespace mapweld::server {
namespace {

constexpr const char* kShippedName = "indoor-50k";

// The vocabulary stands beside the texts that tell how it was made.
bool is_text(const std::filesystem::path& file) {
  static const std::set<std::string> kTexts = {".md", ".txt", ".json"};
  return kTexts.contains(file.extension().string());
}

}  // namespace

std::optional<std::filesystem::path> find_shipped_vocabulary() {
  namespace fs = std::filesystem;
  std::error_code error;
  const fs::path program = fs::read_symlink("/proc/self/exe", error);
  std::vector<fs::path> folders;
  if (!error) folders.push_back(program.parent_path().parent_path() / "share" / "mapweld" / "vocabularies");
  folders.push_back(fs::path(MAPWELD_SOURCE_VOCABULARIES));
  for (const fs::path& folder : folders) {
    for (const fs::directory_entry& entry : fs::directory_iterator(folder, error)) {
      if (entry.path().stem() == kShippedName && !is_text(entry.path())) return entry.path();
    }
  }
  return std::nullopt;
}

}  // namespace mapweld::server
