// What is said of the API and cannot be read off the code: words.json beside this file.
#pragma once

#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "client/contract/json.h"

namespace mapweld::server {

// Answers what is said of a thing, and remembers what was asked for and what is missing.
//
//   info, tags, servers, security          as OpenAPI has them
//   values.NAME                            a kind of value that several fields have, {"is":"NAME"} there; NAME in
//                                          capitals: a schema of its own, {"like": DOCUMENT} but for what it says
//   headers.NAME, parameters.NAME          of any operation
//   operations.ID                          tag, summary, description, parameters.NAME, answers.STATUS, and
//                                          contents.TYPE for what has no document
//   documents.NAME                         description, example, fields.NAME
//   fields.NAME                            of a field that means the same in each document that has it
class Words {
 public:
  explicit Words(std::string_view text);  // of words.json

  // Null where nothing is said; then it is missing, unless it is `optional`.
  contract::Json find(const std::vector<std::string>& path, bool optional = false);

  // Of a field: its document's own words, or those of its name.
  contract::Json field(const std::string& document, const std::string& name);
  // Of a parameter: its operation's own words, or those of its name.
  contract::Json parameter(const std::string& operation, const std::string& name);

  // A schema in whose every level {"is": NAME} is replaced by what NAME is.
  contract::Json resolved(contract::Json schema);

  // "missing: ..." and "left over: ...".
  std::vector<std::string> faults() const;

 private:
  const contract::Json* look_up(const std::vector<std::string>& path) const;

  contract::Json words_;
  std::set<std::string> used_;
  std::set<std::string> missing_;
};

}  // namespace mapweld::server
