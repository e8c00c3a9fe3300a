#include "server/api/api.h"
#include "server/api/cursors.h"
#include "server/api/description/contents.h"
#include "server/api/replies.h"

namespace mapweld::server {

using contract::ContractError;

void add_vocabulary_routes(Router& router, const Services& services) {
  VocabularyService& vocabularies = services.vocabularies;
  router.add({.method = "GET",
              .pattern = "/v1/vocabularies",
              .role = Role::kRead,
              .query = list_query(),
              .says = {.operation = "listVocabularies",
                       .answers = {answers_page<contract::Vocabulary>(), answers_not_modified()}},
              .handler = [&vocabularies, cursors = Cursors(services.store)](const Request& request) {
                return tagged_by_content(cursors.reply(
                    request, [&](const PageRequest& page) { return vocabularies.list(page.limit, page.cursor); }));
              }});
  router.add(
      {.method = "GET",
       .pattern = "/v1/vocabularies/{vocabulary}",
       .role = Role::kRead,
       .says = {.operation = "getVocabulary", .answers = {answers<contract::Vocabulary>(200), answers_not_modified()}},
       .handler = [&vocabularies](const Request& request) {
         return tagged_by_content(json_reply(200, vocabularies.get(request.parameter("vocabulary"))));
       }});
  router.add({.method = "DELETE",
              .pattern = "/v1/vocabularies/{vocabulary}",
              .role = Role::kAdmin,
              .body = BodyRule::kOptional,
              .says = {.operation = "deleteVocabulary", .answers = {answers_nothing()}, .codes = {"vocabulary_in_use"}},
              .handler = [&vocabularies](const Request& request) {
                vocabularies.remove(request.parameter("vocabulary"));
                return no_content();
              }});
  router.add({.method = "POST",
              .pattern = "/v1/vocabularies",
              .role = Role::kAdmin,
              .body = BodyRule::kRequired,
              .query = {"name"},
              .says = {.operation = "addVocabulary",
                       .takes = {{"application/octet-stream"}},
                       .answers = {answers<contract::Vocabulary>(201, {"Location"})},
                       .codes = {"invalid_name", "name_taken", "invalid_vocabulary"}},
              .handler = services.idempotency.once([&vocabularies](const Request& request, Once& once) {
                const auto name = request.query.text("name");
                if (!name) throw ContractError("invalid_name", "Name the vocabulary with ?name=.");
                if (request.body.empty()) throw ContractError("empty_body", "The vocabulary file has no bytes.");
                const auto reply_of = [&](const contract::Vocabulary& vocabulary) {
                  Reply reply = json_reply(201, vocabulary);
                  reply.headers.emplace_back("Location", "/v1/vocabularies/" + *name);
                  return reply;
                };
                return reply_of(vocabularies.add(
                    *name, request.body_bytes(),
                    once.keeps<contract::Vocabulary>([&](WriteTransaction& db, const contract::Vocabulary& added) {
                      once.keep(db, reply_of(added), "");
                    })));
              })});
}

}  // namespace mapweld::server
