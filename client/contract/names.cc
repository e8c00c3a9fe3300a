#include "client/contract/names.h"

#include <cstdint>
#include <string>

#include "client/contract/problem.h"

namespace mapweld::contract {
namespace {

bool is_digit(char c) { return c >= '0' && c <= '9'; }
bool is_letter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); }
bool is_hex(char c) { return is_digit(c) || (c >= 'a' && c <= 'f') || (c >= 'A' && c <= 'F'); }

constexpr std::uint32_t kNotUtf8 = 0xFFFFFFFF;

// Takes one code point off the front of `text` (Unicode 15, table 3-7): kNotUtf8 for overlong forms, surrogates, code
// points beyond U+10FFFF and sequences that break off.
std::uint32_t take_code_point(std::string_view& text) {
  const auto lead = static_cast<unsigned char>(text.front());
  text.remove_prefix(1);
  if (lead < 0x80) return lead;
  const int more = lead >= 0xF0 ? 3 : lead >= 0xE0 ? 2 : 1;
  if (lead < 0xC2 || lead > 0xF4 || text.size() < static_cast<std::size_t>(more)) return kNotUtf8;
  std::uint32_t point = lead & (0x3FU >> more);
  for (int i = 0; i < more; ++i) {
    const auto next = static_cast<unsigned char>(text.front());
    if ((next & 0xC0U) != 0x80) return kNotUtf8;
    point = (point << 6U) | (next & 0x3FU);
    text.remove_prefix(1);
  }
  constexpr std::uint32_t kLeast[] = {0, 0x80, 0x800, 0x10000};
  const bool surrogate = point >= 0xD800 && point <= 0xDFFF;
  return point < kLeast[more] || surrogate || point > 0x10FFFF ? kNotUtf8 : point;
}

}  // namespace

bool is_slug(std::string_view name) {
  if (name.empty() || name.size() > 64 || !(is_digit(name[0]) || is_letter(name[0]))) return false;
  for (const char c : name) {
    if (!(is_digit(c) || is_letter(c) || c == '.' || c == '_' || c == '-')) return false;
  }
  return true;
}

void check_slug(std::string_view name, std::string_view what) {
  if (is_slug(name)) return;
  throw ContractError("invalid_name",
                      std::string(what) +
                          " must be 1 to 64 letters, digits, dots, underscores and hyphens, the first a "
                          "letter or a digit.");
}

bool is_image_name(std::string_view name) {
  if (name.empty() || name.size() > 255) return false;
  while (!name.empty()) {
    const std::uint32_t point = take_code_point(name);
    if (point == kNotUtf8 || point < 0x20 || (point >= 0x7F && point <= 0x9F)) return false;
  }
  return true;
}

void check_image_name(std::string_view name) {
  if (is_image_name(name)) return;
  throw ContractError("invalid_name", "An image's name must be 1 to 255 bytes of UTF-8 without control characters.");
}

bool is_uuid(std::string_view text) {
  if (text.size() != 36) return false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const bool hyphen = i == 8 || i == 13 || i == 18 || i == 23;
    if (hyphen ? text[i] != '-' : !is_hex(text[i])) return false;
  }
  return true;
}

}  // namespace mapweld::contract
