#include "server/events/map_events.h"

#include "client/contract/codec.h"
#include "client/contract/json.h"

namespace mapweld::server {

using contract::Json;

void tell_map(EventHub& hub, const std::string& map, const std::string& change) {
  hub.tell({.type = "map", .data = contract::dump(Json{{"map", map}, {"change", change}}), .maps = {map}});
}

void tell_image(EventHub& hub, const std::string& map, const contract::Upload& upload) {
  Json data = {{"map", map}};
  data.update(Json(upload));
  hub.tell({.type = "image", .data = contract::dump(data), .maps = {map}});
}

}  // namespace mapweld::server
