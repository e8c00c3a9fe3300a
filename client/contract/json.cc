#include "client/contract/json.h"

#include <set>
#include <vector>

#include "client/contract/problem.h"

namespace mapweld::contract {

Json parse_json(std::string_view text) {
  if (text.find_first_not_of(" \t\r\n") == std::string_view::npos) {
    throw ContractError("empty_body", "The body is empty; a JSON document is expected.");
  }
  std::vector<std::set<std::string>> keys;  // of the objects that are open
  const auto guard = [&](int depth, Json::parse_event_t event, Json& parsed) {
    switch (event) {
      case Json::parse_event_t::object_start:
      case Json::parse_event_t::array_start:
        if (depth >= kMaxJsonDepth) {
          throw ContractError("malformed_json",
                              "The document is nested more than " + std::to_string(kMaxJsonDepth) + " levels deep.");
        }
        if (event == Json::parse_event_t::object_start) keys.emplace_back();
        break;
      case Json::parse_event_t::object_end:
        keys.pop_back();
        break;
      case Json::parse_event_t::key:
        if (keys.back().size() == kMaxJsonFields) {
          throw ContractError("malformed_json",
                              "An object has more than " + std::to_string(kMaxJsonFields) + " fields.");
        }
        if (!keys.back().insert(parsed.get<std::string>()).second) {
          throw ContractError("malformed_json", "The field \"" + parsed.get<std::string>() + "\" appears twice.");
        }
        break;
      default:
        break;
    }
    return true;
  };
  try {
    return Json::parse(text.begin(), text.end(), guard);
  } catch (const Json::parse_error& error) {
    throw ContractError("malformed_json", "The body is not JSON: it breaks off or goes wrong at byte " +
                                              std::to_string(error.byte) + ".");
  } catch (const Json::out_of_range&) {
    throw ContractError("malformed_json", "The body has a number that is out of range.");
  }
}

std::string dump(const Json& document) { return document.dump(-1, ' ', false, Json::error_handler_t::replace); }

}  // namespace mapweld::contract
