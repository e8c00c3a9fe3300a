#include <string>

#include "server/api/api.h"
#include "server/api/description/contents.h"
#include "server/api/replies.h"
#include "server/events/map_events.h"
#include "server/http/files/file_reply.h"

namespace mapweld::server {

void add_transfer_routes(Router& router, const Services& services) {
  MapTransfer& transfer = services.transfer;
  EventHub& events = services.events;
  router.add({.method = "GET",
              .pattern = "/v1/maps/{map}/export",
              .role = Role::kRead,
              .query = {"images"},
              .says = {.operation = "exportMap",
                       .answers = answers_file("application/vnd.sqlite3"),
                       .codes = {"map_is_merged"}},
              .handler = [&transfer](const Request& request) {
                const std::string& map = request.parameter("map");
                const MapTransfer::Exported exported =
                    transfer.export_map(map, {.pixels = request.query.boolean("images").value_or(true)});
                Reply reply =
                    file_reply(request, exported.file, "application/vnd.sqlite3", "\"" + exported.state + "\"");
                reply.headers.emplace_back("Content-Disposition", "attachment; filename=\"" + map + ".mapweld\"");
                return reply;
              }});
  router.add(
      {.method = "POST",
       .pattern = "/v1/maps:import",
       .role = Role::kWrite,
       .body = BodyRule::kFile,
       .query = {"name"},
       .says = {.operation = "importMap",
                .takes = {{"application/vnd.sqlite3"}},
                .answers = {answers<contract::Map>(201, {"Location"})},
                .codes = {"invalid_name", "name_taken", "vocabulary_mismatch", "damaged_file", "quota_exceeded"}},
       .handler = services.idempotency.once([&transfer, &events](const Request& request, Once& once) {
         if (request.body_file->bytes() == 0) throw contract::ContractError("empty_body", "The file is empty.");
         const contract::Map map =
             transfer.import_map(request.body_file->path(), request.query.text("name"), request.caller.get(),
                                 once.keeps<contract::Map>([&](WriteTransaction& db, const contract::Map& made) {
                                   once.keep(db, map_made(made), made.name);
                                 }));
         tell_map(events, map.name, "created");
         return map_made(map);
       })});
}

}  // namespace mapweld::server
