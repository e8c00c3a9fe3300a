#include "client/contract/problem.h"

namespace mapweld::contract {

Code Code::find(std::string_view word) {
  for (const CodeEntry& entry : kCodes) {
    if (entry.code == word) return Code(entry);
  }
  return "internal_error";
}

}  // namespace mapweld::contract
