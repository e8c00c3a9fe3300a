// What routes take and answer, in few words.
#pragma once

#include <string>
#include <vector>

#include "server/api/description/schema_book.h"
#include "server/http/route_description.h"

namespace mapweld::server {

template <class Document>
Content json_of() {
  return {"application/json", &document_schema<Document>};
}

// One JSON document.
template <class Document>
AnswerDescription answers(int status, std::vector<std::string> headers = {}) {
  return {status, {json_of<Document>()}, std::move(headers)};
}

template <class Item>
AnswerDescription answers_page() {
  return answers<contract::Page<Item>>(200);
}

inline AnswerDescription answers_nothing() { return {204}; }

// To who has the answer already. That the other answers have an ETag follows.
inline AnswerDescription answers_not_modified() { return {304}; }

inline std::vector<Content> pictures() { return {{"image/jpeg"}, {"image/png"}}; }

// A file, whole or in ranges.
inline std::vector<AnswerDescription> answers_file(const std::string& media_type) {
  const std::vector<std::string> headers = {"Accept-Ranges", "Content-Disposition", "ETag"};
  std::vector<std::string> partial = headers;
  partial.emplace_back("Content-Range");
  return {{200, {{media_type}}, headers}, {206, {{media_type}}, partial}, {304}};
}

}  // namespace mapweld::server
