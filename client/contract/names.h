// What maps, vocabularies and images may be called.
#pragma once

#include <string_view>

namespace mapweld::contract {

// Slugs name maps and vocabularies: [A-Za-z0-9][A-Za-z0-9._-]{0,63}.
bool is_slug(std::string_view name);
// Throws ContractError(invalid_name) for what is not a slug. `what` begins the detail: "The map's name".
void check_slug(std::string_view name, std::string_view what);

// Images are named by 1 to 255 bytes of UTF-8 without control characters (U+0000 to U+001F, U+007F to U+009F).
bool is_image_name(std::string_view name);
// Throws ContractError(invalid_name) for what is not an image name.
void check_image_name(std::string_view name);

// A version 1 to 8 UUID in its usual form, 8-4-4-4-12 hexadecimal digits of either case.
bool is_uuid(std::string_view text);

}  // namespace mapweld::contract
