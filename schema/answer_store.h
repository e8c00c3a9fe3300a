// Answers that are kept under the keys of their requests, to be given again (docs/http-api.md, "Asking once").
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "schema/store.h"
#include "schema/store_types.h"

namespace mapweld {

// A key is its caller's own.
struct AnswerKey {
  std::int64_t caller = 0;  // id of the key that the caller showed (key_store.h); 0: nobody was asked who they are
  std::string text;
};

struct KeptAnswer {
  std::int64_t part = 0;  // of a batch
  Sha256 request{};       // what was asked
  int status = 0;
  std::string headers;  // "name: value" lines
  std::string body;
  std::optional<MapId> map;  // that it tells of
  Timestamp kept_at{};
};

// Those of a key that were kept at `since` or later, by part.
std::vector<KeptAnswer> find_answers(const Reader& db, const AnswerKey& key, Timestamp since);

// In the place of one that was kept under this key for this part.
void keep_answer(WriteTransaction& db, const AnswerKey& key, const KeptAnswer& answer);

// Drops answers that were kept before `before`, the oldest first, at most so many.
void drop_answers(WriteTransaction& db, Timestamp before, std::size_t most);

// Drops all that tell of a map, or of maps that are no more.
void drop_answers_of(WriteTransaction& db, MapId map);
void drop_answers_of_deleted_maps(WriteTransaction& db);

}  // namespace mapweld
