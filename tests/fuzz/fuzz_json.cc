// A JSON document: refused, or what is written of it is read as the same.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "client/contract/json.h"
#include "client/contract/problem.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace mapweld::contract;
  try {
    const Json document = parse_json({reinterpret_cast<const char*>(data), size});
    if (parse_json(dump(document)) != document) std::abort();
  } catch (const ContractError&) {
  }
  return 0;
}
