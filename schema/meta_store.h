// Table `meta`: facts about the database itself, by name.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "schema/store.h"

namespace mapweld {

std::optional<std::string> find_meta(const Reader& db, std::string_view key);

// In place of what it was.
void set_meta(WriteTransaction& db, std::string_view key, std::string_view value);

}  // namespace mapweld
