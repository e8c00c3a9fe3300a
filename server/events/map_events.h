// What happens to maps, as events.
#pragma once

#include <string>

#include "client/contract/image.h"
#include "server/events/event_hub.h"

namespace mapweld::server {

// `change`: "created", "changed", "deleted", "mask"; "images": some were deleted or restored.
void tell_map(EventHub& hub, const std::string& map, const std::string& change);

// An image is stored, as a vertex or as an ignored one.
void tell_image(EventHub& hub, const std::string& map, const contract::Upload& upload);

}  // namespace mapweld::server
