#include "server/http/wire/entity_tag.h"

#include "server/http/wire/text.h"

namespace mapweld::server {
namespace {

std::string_view without_weakness(std::string_view etag) {
  if (etag.starts_with("W/")) etag.remove_prefix(2);
  return etag;
}

}  // namespace

bool names_entity_tag(std::string_view if_none_match, std::string_view etag) {
  std::string_view left = trim(if_none_match);
  if (left == "*") return true;
  const std::string_view wanted = without_weakness(etag);
  while (!left.empty()) {
    const std::string_view tag = without_weakness(left);
    // A tag may have commas in it: it ends with its quote.
    const std::size_t end = tag.starts_with('"') ? tag.find('"', 1) : std::string_view::npos;
    if (end != std::string_view::npos && tag.substr(0, end + 1) == wanted) return true;
    const std::size_t comma = tag.find(',', end == std::string_view::npos ? 0 : end);
    left = comma == std::string_view::npos ? "" : trim(tag.substr(comma + 1));
  }
  return false;
}

}  // namespace mapweld::server
