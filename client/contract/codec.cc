#include "client/contract/codec.h"

namespace mapweld::contract::detail {

void throw_wrong_type(const Place& place, std::string_view expected, const Json& found) {
  std::string kind = found.type_name();
  if (kind == "number") kind = "the number " + dump(found);
  if (kind == "object" || kind == "array") kind = "an " + kind;
  if (kind == "string" || kind == "boolean") kind = "a " + kind;
  throw ContractError(place.wrong_type, place.name() + " must be " + std::string(expected) + ", not " + kind + ".");
}

void throw_out_of_range(const Place& place) {
  throw ContractError(place.wrong_type, place.name() + " is out of range.");
}

void throw_unknown_field(const Place& place) {
  throw ContractError("unknown_field", "There is no field " + place.name() + ".");
}

void throw_missing_field(const Place& place) {
  throw ContractError(place.wrong_type, "The field " + place.name() + " is missing.");
}

}  // namespace mapweld::contract::detail
