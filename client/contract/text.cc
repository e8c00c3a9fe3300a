#include "client/contract/text.h"

#include <algorithm>

namespace mapweld::contract::detail {

void append_string(std::string& out, std::string_view text) {
  const bool is_plain = std::ranges::all_of(text, [](char c) {
    const auto byte = static_cast<unsigned char>(c);
    return byte >= 0x20 && byte < 0x80 && byte != '"' && byte != '\\';
  });
  if (is_plain) {
    out.append("\"").append(text).append("\"");
  } else {
    out += dump(Json(text));
  }
}

}  // namespace mapweld::contract::detail
