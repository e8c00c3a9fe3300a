// What a route says of itself, for the description of the API (server/api/description). Words are not here.
#pragma once

#include <string>
#include <vector>

#include "client/contract/json.h"
#include "client/contract/problem.h"

namespace mapweld::server {

class SchemaBook;

// Enters the schema of a document, and of those in it, and gives a reference to it.
using SchemaOf = contract::Json (*)(SchemaBook&);

struct Content {
  std::string media_type;
  SchemaOf schema = nullptr;  // null: bytes, or text
};

struct AnswerDescription {
  int status = 200;
  std::vector<Content> contents = {};     // one of them
  std::vector<std::string> headers = {};  // its own; those that every answer of its kind has are not listed
};

struct RouteDescription {
  std::string operation;                        // its name for programs, unique: "createMap"
  std::vector<Content> takes = {};              // one of them, as the body
  std::vector<AnswerDescription> answers = {};  // but for problems
  // Problems of its own. Those that follow from the rest of the route (role, path, query, body) are not listed.
  std::vector<contract::Code> codes = {};
};

}  // namespace mapweld::server
