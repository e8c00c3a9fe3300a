// Includes run one way: schema -> core; server -> schema, core, the client's contract and what it draws figures with;
// client -> no sibling.
// And core is pure: no SQL, HTTP, JSON, clock or file.
#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

namespace {

namespace fs = std::filesystem;

struct Include {
  std::string file;  // relative to the source root
  int line = 0;
  std::string header;
};

std::vector<Include> includes_below(const fs::path& root, const std::string& folder) {
  static const std::regex pattern(R"rx(^\s*#\s*include\s*[<"]([^>"]+)[>"])rx");
  std::vector<Include> found;
  for (const auto& entry : fs::recursive_directory_iterator(root / folder)) {
    const auto extension = entry.path().extension();
    if (extension != ".h" && extension != ".cc") continue;
    std::ifstream in(entry.path());
    std::string text;
    for (int line = 1; std::getline(in, text); ++line) {
      std::smatch match;
      if (std::regex_search(text, match, pattern)) {
        found.push_back({fs::relative(entry.path(), root).string(), line, match[1].str()});
      }
    }
  }
  return found;
}

bool starts_with_any(std::string_view text, const std::vector<std::string>& prefixes) {
  for (const auto& prefix : prefixes) {
    if (text.starts_with(prefix)) return true;
  }
  return false;
}

const fs::path kRoot = MAPWELD_SOURCE_DIR;

TEST(IncludeDirection, NoArrowRunsBack) {
  const std::vector<std::string> siblings = {"core/", "schema/", "server/", "client/", "tests/"};
  const std::map<std::string, std::vector<std::string>> allowed = {
      {"core", {"core/"}},
      {"schema", {"core/", "schema/"}},
      {"server", {"core/", "schema/", "server/", "client/contract/", "client/drawing/svg.h", "client/drawing/axis.h"}},
      {"client", {"client/"}},
  };
  for (const auto& [folder, may_include] : allowed) {
    const auto includes = includes_below(kRoot, folder);
    EXPECT_FALSE(includes.empty()) << folder << " has no sources: the test looks in the wrong place";
    for (const auto& include : includes) {
      if (!starts_with_any(include.header, siblings)) continue;
      EXPECT_TRUE(starts_with_any(include.header, may_include))
          << include.file << ":" << include.line << " includes " << include.header;
    }
  }
}

TEST(IncludeDirection, CoreIsPure) {
  const std::set<std::string> impure = {"sqlite3.h", "httplib.h", "chrono",     "ctime",      "time.h",
                                        "fstream",   "cstdio",    "stdio.h",    "iostream",   "filesystem",
                                        "unistd.h",  "fcntl.h",   "sys/time.h", "sys/stat.h", "sys/mman.h"};
  // FLANN saves an index to a FILE* and nothing else (here: a stream over memory); the headers of libjpeg and libpng
  // need the name FILE declared. No file is opened.
  const std::set<std::pair<std::string, std::string>> excused = {{"core/vocabulary/flann_index.cc", "cstdio"},
                                                                 {"core/feature/jpeg.cc", "cstdio"},
                                                                 {"core/feature/png.cc", "cstdio"}};
  for (const auto& include : includes_below(kRoot, "core")) {
    if (excused.contains({include.file, include.header})) continue;
    EXPECT_FALSE(impure.contains(include.header) || include.header.starts_with("nlohmann/") ||
                 include.header.starts_with("spdlog/"))
        << include.file << ":" << include.line << " includes " << include.header;
  }
}

}  // namespace
