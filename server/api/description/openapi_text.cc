#include <string>

#include "server/api/description/describe.h"

namespace mapweld::server {
namespace {

using contract::Json;

constexpr std::size_t kLineLength = 120;

void write(std::string& out, const Json& value, std::size_t indent, std::size_t taken) {
  const std::string line = value.dump();
  if (!value.is_structured() || value.empty() || indent + taken + line.size() <= kLineLength) {
    out += line;
    return;
  }
  const char* const brackets = value.is_object() ? "{}" : "[]";
  out += brackets[0];
  bool first = true;
  for (const auto& [key, part] : value.items()) {
    out += first ? "\n" : ",\n";
    first = false;
    out.append(indent + 1, ' ');
    const std::string name = value.is_object() ? Json(key).dump() + ": " : "";
    out += name;
    write(out, part, indent + 1, name.size() + 1);
  }
  out += "\n";
  out.append(indent, ' ');
  out += brackets[1];
}

}  // namespace

std::string openapi_text(const Json& document) {
  std::string text;
  write(text, document, 0, 0);
  return text + "\n";
}

}  // namespace mapweld::server
