// ETags of answers that follow from what a map shows.
#pragma once

#include <string>
#include <utility>

#include "schema/maps/map_layout.h"
#include "schema/store.h"
#include "server/http/message.h"
#include "server/maps/map_opener.h"
#include "server/services/hashing.h"
#include "server/services/map_lookup.h"
#include "server/services/uuid.h"

namespace mapweld::server {

// Weak ones, each of one path and query: who has one was answered there, so that a request that would be refused is not
// answered 304. After a start they are others: a folder that was restored counts the same revisions again.
class RevisionTags {
 public:
  // `store` must outlive the handlers.
  explicit RevisionTags(Store& store) : store_(store), start_(make_uuid().substr(0, 8)) {}

  // A handler whose answers follow from the map in the path and the query: the same, with a tag, and not asked for what
  // a client has. Throws ContractError no_such_map too.
  Handler operator()(Handler handler) const {
    return [&store = store_, start = start_, handler = std::move(handler)](const Request& request) {
      // Read before the answer is: one that is newer than its tag is only asked for once more.
      std::string etag =
          "W/\"" + start + "-" + what_is_shown(store, request.parameter("map")) + "-" + what_is_asked(request) + "\"";
      Reply reply;
      if (request.if_none_match != "*" && request.knows(etag)) {
        reply.content_type = "application/json";  // or other text
      } else {
        reply = handler(request);
      }
      reply.etag = std::move(etag);
      return reply;
    };
  }

 private:
  static std::string what_is_asked(const Request& request) {
    std::string asked = request.path;
    for (const auto& [name, value] : request.query.values()) asked += '\n' + name + '\n' + value;
    return to_hex(sha256({reinterpret_cast<const std::uint8_t*>(asked.data()), asked.size()})).substr(0, 16);
  }
  static std::string what_is_shown(Store& store, const std::string& name) {
    const ReadTransaction db = store.read();
    const MapLayout layout = load_layout(db, require_map(db, name).id);
    return std::to_string(to_index(layout.map())) + "-" + std::to_string(shown_revision(db, layout));
  }

  Store& store_;
  const std::string start_;
};

}  // namespace mapweld::server
