// What the API answers, held against what its description says.
#pragma once

#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "server/http/router.h"

namespace mapweld::test {

struct Exchange {
  std::string method;
  std::string path;          // with its query
  std::string request = {};  // its body
  int status = 0;
  std::string type = {};   // of the reply
  std::string reply = {};  // its body
  std::vector<std::string> headers = {};
};

// Knows the description of these routes by heart. Thread-safe.
class DescribedApi {
 public:
  explicit DescribedApi(const std::vector<server::Route>& routes);
  ~DescribedApi();

  // What an exchange has that the document has not: a status, a header, a media type, a code, a field, a value of
  // another type or range; of a request only where it was taken and is JSON. Empty when all is said.
  std::vector<std::string> undescribed(const Exchange& exchange) const;

  // What is wrong with a value by a schema of the document, in which no object has fields that the schema does not
  // name.
  std::vector<std::string> faults(const nlohmann::json& schema, const nlohmann::json& value) const;

  const nlohmann::json& document() const { return document_; }

 private:
  struct Prepared;

  const nlohmann::json& resolve(const nlohmann::json& node) const;
  void check_body(const nlohmann::json& contents, const std::string& type, const std::string& body,
                  std::vector<std::string>& said) const;

  server::Router router_;
  nlohmann::json document_;
  nlohmann::json prepared_components_;  // its own, with every object's fields closed
  mutable std::mutex mutex_;
  mutable std::map<std::string, std::unique_ptr<Prepared>> prepared_;
};

}  // namespace mapweld::test
