// What a key may do, and what a route asks for: a ladder, each step with all below it.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>

namespace mapweld::server {

enum class Role : std::uint8_t {
  kAnybody,  // no key is asked for
  kRead,     // looking, localizing
  kWrite,    // making, filling and deleting maps
  kOperate,  // merges
  kAdmin,    // what is the whole server's: vocabularies, backups
};

inline constexpr std::array<std::string_view, 5> kRoleWords = {"anybody", "read", "write", "operate", "admin"};

constexpr std::string_view to_string(Role role) { return kRoleWords[static_cast<std::size_t>(role)]; }

// Of a key: "anybody" is none.
constexpr std::optional<Role> parse_role(std::string_view word) {
  for (std::size_t i = 1; i < kRoleWords.size(); ++i) {
    if (kRoleWords[i] == word) return static_cast<Role>(i);
  }
  return std::nullopt;
}

}  // namespace mapweld::server
