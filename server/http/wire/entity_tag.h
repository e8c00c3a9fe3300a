// Conditional requests (RFC 9110, section 13.1.2).
#pragma once

#include <string_view>

namespace mapweld::server {

// Whether `if_none_match`, the value of such a field, names `etag` or is "*". Tags are compared weakly, as the RFC has
// it: with or without "W/" they are the same. What is no tag names nothing.
bool names_entity_tag(std::string_view if_none_match, std::string_view etag);

}  // namespace mapweld::server
