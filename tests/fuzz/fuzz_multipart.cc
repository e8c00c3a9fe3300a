// A batch: the first line is the Content-Type, the rest the body. Parts lie in the body.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <string_view>

#include "client/contract/problem.h"
#include "server/http/multipart.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  const std::size_t line = std::min(text.find('\n'), text.size());
  const std::string_view body = text.substr(std::min(line + 1, text.size()));
  try {
    const std::string boundary = mapweld::server::multipart_boundary(text.substr(0, line));
    for (const auto& part : mapweld::server::parse_multipart(body, boundary, 64)) {
      if (part.content.data() < body.data() || part.content.data() + part.content.size() > body.data() + body.size()) {
        std::abort();
      }
    }
  } catch (const mapweld::contract::ContractError&) {
  }
  return 0;
}
