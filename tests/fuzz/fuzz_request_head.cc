// The head of a request, in pieces: taken or refused, and the same whatever the pieces are.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <optional>
#include <string_view>

#include "client/contract/problem.h"
#include "server/http/wire/head_parser.h"

namespace {

using mapweld::server::Head;
using mapweld::server::HeadParser;

// The head, and how many bytes it took; none: refused, or not complete.
struct Taken {
  std::optional<Head> head;
  std::size_t bytes = 0;
};

Taken take(std::string_view text, std::size_t piece_bytes) {
  HeadParser parser(16 * 1024, 8 * 1024);
  std::size_t at = 0;
  try {
    while (at < text.size()) {
      const std::string_view whole = text.substr(at, piece_bytes);
      std::string_view piece = whole;
      const bool complete = parser.take(piece);
      at += whole.size() - piece.size();
      if (complete) return {parser.head(), at};
      if (piece.size() == whole.size()) break;
    }
  } catch (const mapweld::contract::ContractError&) {
  }
  return {};
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const std::string_view text(reinterpret_cast<const char*>(data + 1), size - 1);
  const Taken whole = take(text, text.size());
  const Taken pieces = take(text, 1 + data[0] % 16);
  if (whole.head.has_value() != pieces.head.has_value() || whole.bytes != pieces.bytes) std::abort();
  if (whole.head && (whole.head->target != pieces.head->target || whole.head->fields != pieces.head->fields))
    std::abort();
  return 0;
}
