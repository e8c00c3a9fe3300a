#include <string>

#include "server/api/api.h"
#include "server/api/cursors.h"
#include "server/api/description/contents.h"
#include "server/api/replies.h"
#include "server/http/files/file_reply.h"

namespace mapweld::server {
namespace {

std::int64_t backup_in_path(const Request& request) {
  return number_in_path<std::int64_t>(request, "backup", "no_such_backup");
}

}  // namespace

void add_backup_routes(Router& router, const Services& services) {
  BackupService& backups = services.backups;
  router.add({.method = "POST",
              .pattern = "/v1/backups",
              .role = Role::kAdmin,
              .body = BodyRule::kOptional,
              .says = {.operation = "beginBackup",
                       .answers = {answers<contract::Backup>(202, {"Location"})},
                       .codes = {"wrong_state"}},
              .handler = services.idempotency.once([&backups](const Request&, Once&) {
                const contract::Backup backup = backups.begin();
                Reply reply = json_reply(202, backup);
                reply.subject = std::to_string(backup.id);
                reply.headers.emplace_back("Location", "/v1/backups/" + std::to_string(backup.id));
                return reply;
              })});
  router.add({.method = "GET",
              .pattern = "/v1/backups",
              .role = Role::kAdmin,
              .query = list_query(),
              .says = {.operation = "listBackups", .answers = {answers_page<contract::Backup>()}},
              .handler = [&backups, cursors = Cursors(services.store)](const Request& request) {
                return cursors.reply(request,
                                     [&](const PageRequest& page) { return backups.list(page.limit, page.cursor); });
              }});
  router.add({.method = "GET",
              .pattern = "/v1/backups/{backup}",
              .role = Role::kAdmin,
              .says = {.operation = "getBackup", .answers = {answers<contract::Backup>(200)}},
              .handler = [&backups](const Request& request) {
                return json_reply(200, backups.get(backup_in_path(request)));
              }});
  router.add({.method = "GET",
              .pattern = "/v1/backups/{backup}/content",
              .role = Role::kAdmin,
              .says = {.operation = "getBackupFile",
                       .answers = answers_file("application/vnd.sqlite3"),
                       .codes = {"wrong_state"}},
              .handler = [&backups](const Request& request) {
                const std::int64_t id = backup_in_path(request);
                const std::string name = "mapweld-backup-" + std::to_string(id) + ".db";
                Reply reply =
                    file_reply(request, backups.open(id), "application/vnd.sqlite3", "\"" + std::to_string(id) + "\"");
                reply.headers.emplace_back("Content-Disposition", "attachment; filename=\"" + name + "\"");
                return reply;
              }});
  router.add({.method = "DELETE",
              .pattern = "/v1/backups/{backup}",
              .role = Role::kAdmin,
              .body = BodyRule::kOptional,
              .says = {.operation = "deleteBackup", .answers = {answers_nothing()}},
              .handler = [&backups](const Request& request) {
                backups.remove(backup_in_path(request));
                return no_content();
              }});
}

}  // namespace mapweld::server
