// What the handlers share: reading paging and numbers, writing JSON.
#pragma once

#include <charconv>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "client/contract/codec.h"
#include "client/contract/json.h"
#include "client/contract/page.h"
#include "client/contract/problem.h"
#include "client/contract/text.h"
#include "server/http/message.h"
#include "server/services/hashing.h"
#include "server/services/map_service.h"

namespace mapweld::server {

template <typename Document>
Reply json_reply(int status, const Document& document) {
  Reply reply;
  reply.status = status;
  reply.content_type = "application/json";
  reply.body = contract::to_text(document);
  return reply;
}

inline Reply no_content() {
  Reply reply;
  reply.status = 204;
  return reply;
}

// For answers that are cheap to make and hardly ever change.
inline Reply tagged_by_content(Reply reply) {
  reply.etag =
      "W/\"" + to_hex(sha256({reinterpret_cast<const std::uint8_t*>(reply.body.data()), reply.body.size()})) + "\"";
  return reply;
}

// The bytes as they are stored, with their hash as ETag.
inline Reply image_reply(StoredImage image) {
  Reply reply;
  reply.content_type = std::move(image.media_type);
  reply.body = std::move(image.bytes);
  reply.etag = "\"" + image.sha256 + "\"";
  return reply;
}

inline Reply map_made(const contract::Map& map) {
  Reply reply = json_reply(201, map);
  reply.subject = map.name;
  reply.headers.emplace_back("Location", "/v1/maps/" + map.name);
  return reply;
}

// The query parameters that every list knows, with the list's own.
inline std::vector<std::string> list_query(std::vector<std::string> own = {}) {
  own.insert(own.end(), {"limit", "cursor"});
  return own;
}

// A number in the path. What is no number names nothing: `missing` is answered.
template <typename Number>
Number number_in_path(const Request& request, const std::string& name, contract::Code missing) {
  const std::string& text = request.parameter(name);
  Number number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc{} || end != text.data() + text.size() || number < 0) {
    throw contract::ContractError(missing, "\"" + text + "\" is not the number of one.");
  }
  return number;
}

// /pairs/{u}/{v}?matches=
struct VertexPair {
  std::uint32_t u = 0;
  std::uint32_t v = 0;
  bool with_matches = false;
};
inline VertexPair pair_in_path(const Request& request) {
  return {.u = number_in_path<std::uint32_t>(request, "u", "no_such_vertex"),
          .v = number_in_path<std::uint32_t>(request, "v", "no_such_vertex"),
          .with_matches = request.query.boolean("matches").value_or(false)};
}

}  // namespace mapweld::server
