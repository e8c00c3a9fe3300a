// The secret that a client shows: how it is made, and how it is found in a request.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace mapweld::server {

// "mw_" and 256 random bits in base64url.
std::string make_key();

// The key in an Authorization field: "Bearer KEY" (RFC 6750). nullopt for any other scheme, an empty field, or several.
std::optional<std::string_view> bearer_key(std::string_view authorization);

}  // namespace mapweld::server
